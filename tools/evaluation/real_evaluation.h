#pragma once

#include <array>
#include <filesystem>
#include <functional>

#include "firmware_host/error.h"
#include "tools/evaluation/skeleton_tracker.h"
#include "tracker/motions/motion.h"

namespace armature::tools {

struct JointDeviation {
  double median_m = 0;
  double p90_m = 0;
};

/// Agreement with the Kinect SDK's joints, which are estimates too. Deviation: distance after removing one constant
/// offset a sequence and joint.
struct RealAgreement {
  std::array<JointDeviation, kNavigationJoints.size()> joints{};
  JointDeviation all;
  JointDeviation knees;
  double within_15_cm = 0;  ///< share of joints after removing one constant offset a joint, the same for everybody
  /// Correlation of motion angles, mean over the sequences where the SDK's angle spans more than 10 degrees; 0 where
  /// there are none.
  PerMotion<double> correlation{};
};

struct RealEvaluation {
  int sequences = 0;
  int frames = 0;
  double frames_tracked = 0;   ///< share with every navigation joint observed or inferred
  double joints_observed = 0;  ///< share of navigation joints
  RealAgreement as_is;
  RealAgreement delayed;          ///< the SDK's joints 1.5 frames later, which is when the depth shows what they say
  double p50_us = 0, p99_us = 0;  ///< forest and joints, a frame
};

[[nodiscard]] Expected<RealEvaluation> evaluate_real(SkeletonTracker& tracker, const std::filesystem::path& folder,
                                                     bool all_actions, const std::function<void(double)>& progress);

}  // namespace armature::tools
