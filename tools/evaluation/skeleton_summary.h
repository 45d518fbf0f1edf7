#pragma once

#include <functional>
#include <span>

#include "tools/evaluation/scene_evaluation.h"

namespace armature::tools {

struct JointAccuracy {
  double mean_error_m = 0;  ///< as median and p90 over the joints that were given a position
  double median_error_m = 0;
  double p90_error_m = 0;
  double average_precision = 0;  ///< within 10 cm, by confidence; a joint without a position counts as not found
};

struct AngleAccuracy {
  double mean_deg = 0;
  double p95_deg = 0;
};

/// How well a system does over some scenes. Joints outside the image do not count, hidden ones do.
struct SkeletonSummary {
  int scenes = 0;
  int frames = 0;
  double frames_tracked = 0;  ///< share with a skeleton
  double joints_given = 0;    ///< share of joints with a position
  std::array<JointAccuracy, kJointCount> joints{};
  JointAccuracy navigation;  ///< means over the navigation joints
  JointAccuracy all;         ///< means over all joints
  PerMotion<AngleAccuracy> motions{};
  AngleAccuracy motion;  ///< over the seven motions together
  int rest_frames = 0;
  double at_rest = 0;  ///< share of rest_frames with both velocities exactly zero
  int swaps = 0;       ///< exchanges of left and right that last longer than two frames
  double p50_us = 0, p99_us = 0;
};

/// Over the scenes and joint samples that are wanted.
[[nodiscard]] SkeletonSummary summarise(const std::vector<Scene>& scenes, std::span<const SceneRecord> records,
                                        System system, const std::function<bool(const Scene&)>& wanted);
[[nodiscard]] SkeletonSummary summarise(const std::vector<Scene>& scenes, std::span<const SceneRecord> records,
                                        System system);

/// Joints as a function of the user's distance, in steps of a quarter of a metre.
struct DistanceRow {
  double near_m = 0, far_m = 0;
  std::size_t samples = 0;
  JointAccuracy navigation;
  JointAccuracy all;
};
[[nodiscard]] std::vector<DistanceRow> by_distance(std::span<const SceneRecord> records, System system);

/// The categories in the order of the scenes.
[[nodiscard]] std::vector<std::string> categories_of(const std::vector<Scene>& scenes);

}  // namespace armature::tools
