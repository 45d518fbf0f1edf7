#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>

#include "tracker/body/skeleton.h"
#include "tracker/motions/one_euro.h"

namespace armature {

/// Calms a skeleton: a One-Euro filter for each joint, so that a joint at rest keeps still and one that moves is not
/// late. The less sure a joint is, the more of its speed is taken for noise; and one that is less sure than it usually
/// is, because somebody steps before it, is held back. A joint that is lost is left alone, and starts anew when it is
/// found again.
/// Deterministic. Thread-safe: no. Realtime-safe: yes.
class SkeletonFilter {
 public:
  /// Speeds are in m/s: the coefficient is in Hz per m/s. A joint that is held back lags: that is no speed of its own.
  static constexpr OneEuroOptions kDefault{.min_cutoff_hz = 0.7F,
                                           .speed_coefficient = 80,
                                           .derivative_cutoff_hz = 1.5F,
                                           .noise_speed = 0.1F,
                                           .lag_is_speed = false};

  explicit SkeletonFilter(const OneEuroOptions& options = kDefault) : options_(options) {}

  /// Forgets the past: another person, or one who was away.
  void reset() noexcept {
    for (PointOneEuro& joint : joints_) joint.reset();
    usual_.fill(0);
    last_.reset();
  }

  /// Positions at `time`; the user position is filtered too.
  void filter(Skeleton& skeleton, std::chrono::nanoseconds time) noexcept {
    if (last_ && (time <= *last_ || time - *last_ > kForgetAfter)) reset();
    const float dt_s = last_ ? std::chrono::duration<float>(time - *last_).count() : kFrame_s;
    last_ = time;
    for (std::size_t j = 0; j < kJointCount; ++j) {
      Joint& joint = skeleton.joints[j];
      if (joint.state == JointState::Lost) {
        joints_[j].reset();
      } else {
        joint.position = joints_[j].filter(joint.position, dt_s, trusting(joint.confidence, j));
      }
    }
    skeleton.user_position = joints_[kJointCount].filter(skeleton.user_position, dt_s, options_);
  }

 private:
  static constexpr float kFrame_s = 1.0F / 30;
  static constexpr std::chrono::milliseconds kForgetAfter{500};
  static constexpr float kUsualFrames = 90;    // that make what is usual
  static constexpr float kLeastTrust = 0.1F;   // whatever moves in the end is followed
  static constexpr float kHardlySure = 0.01F;  // confidences that differ by less are alike

  /// The filter of a joint of which this much is known now.
  OneEuroOptions trusting(float confidence, std::size_t joint) noexcept {
    float& usual = usual_[joint];
    usual = usual > 0 ? usual + (confidence - usual) / kUsualFrames : confidence;
    const float as_usual = std::clamp((confidence + kHardlySure) / (usual + kHardlySure), kLeastTrust, 1.0F);
    OneEuroOptions options = options_;
    options.min_cutoff_hz *= as_usual;
    options.speed_coefficient *= as_usual * confidence * confidence;
    return options;
  }

  OneEuroOptions options_;
  std::array<PointOneEuro, kJointCount + 1> joints_;  // the last: the user position
  std::array<float, kJointCount> usual_{};            // confidences over the last seconds
  std::optional<std::chrono::nanoseconds> last_;
};

}  // namespace armature
