#pragma once

#include <array>
#include <functional>

#include "tools/evaluation/skeleton_tracker.h"

namespace armature::tools {

struct JointAccuracy {
  double mean_error_m = 0;
  double median_error_m = 0;
  double p90_error_m = 0;
  double average_precision = 0;  ///< within 10 cm; a joint that is not observed counts as not found
};

struct SyntheticAccuracy {
  int images = 0;
  double pixels_right = 0;  ///< share of sampled pixels whose most likely part is the true one
  std::array<JointAccuracy, kJointCount> joints{};
  JointAccuracy navigation;  ///< means over the navigation joints
  JointAccuracy all;         ///< means over all joints
};

/// Single frames of people that no training run ever sees, true joints against found ones; joints outside the image do
/// not count.
[[nodiscard]] SyntheticAccuracy evaluate_synthetic(SkeletonTracker& tracker, int image_count,
                                                   const std::function<void(double)>& progress);

}  // namespace armature::tools
