#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "tracker/body/pose.h"
#include "tracker/motions/motion.h"

namespace armature {

/// A value at a time; between two keys it goes smoothly from one to the other, before the first and after the last it
/// rests.
struct Key {
  double time_s = 0;
  double value = 0;
};
[[nodiscard]] double value_at(std::span<const Key> keys, double time_s) noexcept;

/// How much of a motion is performed, in its normalised unit (1 = its full range).
struct MotionTrack {
  MotionId motion = MotionId::LeanBust;
  std::vector<Key> keys;
};

/// Where somebody is on the floor, relative to the place where the user of the script stands: `x` to the camera's right
/// and `nearer` to the camera, metres; heading to her left from facing the camera.
struct Waypoint {
  double time_s = 0;
  double x = 0;
  double nearer = 0;
  double heading = 0;
};

/// Both arms at a time, as ArmPose has them; `right` and `left` where they differ from hanging.
struct ArmKey {
  double time_s = 0;
  std::optional<ArmPose> left;
  std::optional<ArmPose> right;
};

struct ActorScript {
  std::vector<Waypoint> path = {Waypoint{}};
  double appears_s = -1e9;  ///< is in the room from then
  double leaves_s = 1e9;    ///< until then
  std::vector<MotionTrack> motions;
  std::vector<ArmKey> arms;
};

/// What happens before the camera, for named synthetic sources.
struct Script {
  std::string name;
  std::string description;  ///< one line for --help
  double duration_s = 0;
  double rest_s =
      0;  ///< from then on the user stands still for at least 1.5 s, in the pose that motions are held against
  std::vector<ActorScript> actors;  ///< the first one is the user
  /// The pair of motions that the script steers with, where it does.
  struct Steering {
    MotionId turn = MotionId::LeanBust;
    MotionId walk = MotionId::BendKnees;
  };
  std::optional<Steering> steering;
};

/// Every script: each motion alone, pair_a to pair_i of section 3.5.3, arms, stand, walk_in, leave, second_person,
/// demo.
[[nodiscard]] const std::vector<Script>& scripts();

/// Null where there is none of this name.
[[nodiscard]] const Script* find_script(std::string_view name);

}  // namespace armature
