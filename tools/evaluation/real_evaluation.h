#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "firmware_host/error.h"
#include "tools/evaluation/skeleton_tracker.h"
#include "tracker/motions/motion.h"

namespace armature::tools {

struct JointDeviation {
  double median_m = 0;
  double p90_m = 0;
};

/// The correlation of a motion's angles over the sequences in which the SDK's angle spans more than 10 degrees. The
/// mean suffers from sequences in which the SDK's own joints stray; the median does not.
struct AngleCorrelation {
  double mean = 0;  ///< 0 where there is no such sequence
  double median = 0;
  int sequences = 0;
};

/// Agreement with the Kinect SDK's joints, which are estimates too. Deviation: distance after removing one constant
/// offset a sequence and joint.
struct RealAgreement {
  std::array<JointDeviation, kNavigationJoints.size()> joints{};
  JointDeviation all;
  JointDeviation knees;
  double within_15_cm = 0;  ///< share of joints after removing one constant offset a joint, the same for everybody
  PerMotion<AngleCorrelation> correlation{};
};

/// How turns of the trunk correlate with those of its surface, which no joints are needed for (surface_turn.h), over
/// the sequences in which the SDK's angle spans more than 10 degrees. All means over five frames.
struct SurfaceAgreement {
  AngleCorrelation ours, sdk;
  double share_of_ours = 0, share_of_sdk = 0;  ///< of either turn, what the surface shows of it; median over sequences
};

/// One sequence, for looking closer.
struct SequenceAgreement {
  std::string name;
  int frames = 0;
  double median_m = 0;               ///< deviation over all joints, as is
  PerMotion<double> sdk_span_rad{};  ///< largest minus smallest angle of the SDK's joints
  PerMotion<double> our_span_rad{};
  PerMotion<double> correlation{};  ///< as is
  PerMotion<double> correlation_delayed{};
};

struct RealEvaluation {
  std::vector<SequenceAgreement> sequences;
  int frames = 0;
  double frames_tracked = 0;   ///< share with every navigation joint observed or inferred
  double joints_observed = 0;  ///< share of navigation joints
  RealAgreement as_is;
  RealAgreement delayed;  ///< the SDK's joints 1.5 frames later, which is when the depth shows what they say
  RealAgreement filtered, filtered_delayed;  ///< the same of the skeleton that is published: through SkeletonFilter
  /// What would be had by imitating the SDK (sdk_imitation.h): as is, and filtered with the SDK delayed.
  RealAgreement imitating, imitating_filtered_delayed;
  SurfaceAgreement shoulders_surface, hips_surface;
  double p50_us = 0, p99_us = 0;  ///< forest and joints, a frame
};

/// Joints of a person whose pixels are known, whoever finds them.
struct MaskedTracker {
  std::function<void(const Intrinsics&)> reset;
  std::function<const Skeleton&(DepthView, std::span<const std::uint8_t>)> track;

  /// Of a SkeletonTracker or PaperTracker, which has to outlive it.
  template <class Tracker>
  [[nodiscard]] static MaskedTracker of(Tracker& tracker) {
    return {[&](const Intrinsics& k) { tracker.reset(k); },
            [&](DepthView frame, std::span<const std::uint8_t> mask) -> const Skeleton& {
              return tracker.track(frame, mask);
            }};
  }
};

/// The user position P, from which bending forward is measured, is on both sides a joint inside the torso (the SDK's
/// Spine, our Torso): its surface would not compare.
[[nodiscard]] Expected<RealEvaluation> evaluate_real(const MaskedTracker& tracker, const std::filesystem::path& folder,
                                                     bool all_actions, const std::function<void(double)>& progress);

}  // namespace armature::tools
