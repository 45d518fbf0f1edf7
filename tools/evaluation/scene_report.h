#pragma once

#include <filesystem>
#include <vector>

#include "tools/evaluation/scene_evaluation.h"
#include "tools/json_lines.h"

namespace armature::tools {

/// Scenes that were played, one record a scene.
struct PlayedScenes {
  std::vector<Scene> scenes;
  std::vector<SceneRecord> records;
  int width = 320;
  int height = 240;
};

/// Tables for people: joints, distances, categories and motions, all systems side by side.
void print_scenes(const PlayedScenes& played);

/// One JSON object a system ("data": "scenes"), then one a scene and system ("data": "scene").
[[nodiscard]] Expected<void> write_scenes_json(const PlayedScenes& played);

/// SVG pictures in a folder that exists: joint_errors.svg, map_over_distance.svg, map_of_categories.svg.
[[nodiscard]] Expected<void> write_scene_plots(const PlayedScenes& played, const std::filesystem::path& folder);

}  // namespace armature::tools
