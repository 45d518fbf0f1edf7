#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tracker/pipeline.h"

namespace armature::tools {

/// What a script's true joints say and what the tracker makes of its depth, one frame.
struct SteeringFrame {
  bool present = false;  ///< the person is in the room
  bool engaged = false;
  PerMotion<float> true_angle_rad{};
  PerMotion<float> true_normalized{};
  Navigation truth;    ///< of the true joints, through the same transfer functions
  Navigation tracked;  ///< of the depth
  std::chrono::nanoseconds dt{0};
};

/// Plays the synthetic person `uri` (with or without `synth:`) to the tracker, with an automatic rest pose.
[[nodiscard]] Expected<std::vector<SteeringFrame>> run_steering(const std::string& uri,
                                                                std::shared_ptr<const Forest> forest,
                                                                TrackerOptions options);

/// How well one motion comes out over the engaged frames of some runs.
struct MotionAccuracy {
  std::size_t frames = 0;
  double median = 0;  ///< of |tracked - true|, normalised values
  double p95 = 0;
  double slope = 0;  ///< least squares through zero of tracked on true angles, at the delay that fits best
  int delay_frames = 0;
  double gain = 1, far_gain = 1;  ///< MotionOptions with which half of the range and all of it would come out right
  PerMotion<double> crosstalk{};  ///< of this motion's angle: by how much the others are read too large, for
                                  ///< the hips before MotionOptions::read_as_hips takes it off
};
/// `in_force`: with which the runs were made.
[[nodiscard]] MotionAccuracy motion_accuracy(const std::vector<std::vector<SteeringFrame>>& runs, MotionId motion,
                                             const MotionOptions& in_force);

}  // namespace armature::tools
