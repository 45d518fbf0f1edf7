#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "firmware_host/error.h"
#include "tracker/synth/synth_source.h"

namespace armature::tools {

/// Somebody beside the user.
enum class Company : std::uint8_t {
  None,
  Beside,  ///< shoulder to shoulder all the time
  Joins,   ///< comes and stands shoulder to shoulder
  Before,  ///< comes and stands so that the user is partly hidden
  Behind,  ///< passes behind the user
};

/// One of the scenes on which the skeleton is measured (scenes/skeleton.txt). The user rests for its first second.
struct Scene {
  std::string category;
  std::string activity;
  std::uint64_t number = 0;  ///< from 1; names the scene and seeds it
  Posture posture = Posture::Standing;
  Company company = Company::None;
  SynthOptions synth;  ///< all but the size of the image; its seed has the bit kHeldOut

  static constexpr double kFps = 30;
  static constexpr double kDuration_s = 3;
  static constexpr double kRest_s = 1;  ///< nothing before it is measured
};

/// Reads a file of scenes, one a line: category, activity, number, posture, body, girth, clothes, distance in metres,
/// turned in degrees, room, share hidden by furniture (b: from below, s: from the side), what is carried, company;
/// columns separated by blanks, `#` to the end of a line is a comment.
[[nodiscard]] Expected<std::vector<Scene>> read_scenes(const std::filesystem::path& path);

/// The first scene of each category.
[[nodiscard]] std::vector<Scene> first_of_each_category(const std::vector<Scene>& scenes);

/// The names of the activities that a scene may have.
[[nodiscard]] const std::vector<std::string>& activity_names();

/// What happens in a scene. The activity must be one of activity_names().
[[nodiscard]] Script scene_script(const Scene& scene);

/// A scene as a source of frames: the same bytes on every machine.
[[nodiscard]] Expected<std::unique_ptr<SynthSource>> open_scene(const Scene& scene, int width, int height);

}  // namespace armature::tools
