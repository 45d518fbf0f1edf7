#include "tracker/motions/range_adapter.h"

#include <algorithm>
#include <cmath>

namespace armature {
namespace {

constexpr float kMovesFar = 0.4F;  // of the configured range
constexpr float kPercentile = 0.9F;
constexpr float kSpeed = 0.2F;      // of the configured range, a second of moving far
constexpr float kBent_rad = 1.05F;  // a forearm against the upper arm

bool forearm_bent(const Skeleton& skeleton, JointId shoulder, JointId elbow, JointId wrist) noexcept {
  const Joint &s = skeleton[shoulder], &e = skeleton[elbow], &w = skeleton[wrist];
  if (s.state != JointState::Observed || e.state != JointState::Observed || w.state == JointState::Lost) return false;
  const Eigen::Vector3f upper = e.position - s.position, fore = w.position - e.position;
  const float lengths = upper.norm() * fore.norm();
  return lengths > 1e-4F && upper.dot(fore) < std::cos(kBent_rad) * lengths;
}

}  // namespace

void RangeAdapter::reset() noexcept {
  reach_ = {};
  bent_ = {};
}

const PerMotion<float>& RangeAdapter::adapt(const PerMotion<MotionReading>& readings,
                                            const PerMotion<float>& configured_rad, const Skeleton& skeleton,
                                            std::chrono::nanoseconds dt, const AdaptationOptions& options) noexcept {
  using enum JointId;
  const float dt_s = std::chrono::duration<float>(dt).count();
  const bool bent = forearm_bent(skeleton, LeftShoulder, LeftElbow, LeftWrist) ||
                    forearm_bent(skeleton, RightShoulder, RightElbow, RightWrist);
  // What is seen now and then counts: a hidden wrist does not put the mug down.
  bent_ =
      std::clamp<std::chrono::nanoseconds>(bent ? bent_ + dt : bent_ - dt, std::chrono::nanoseconds(0), 2 * kCarries);
  for (std::size_t m = 0; m < kMotionCount; ++m) {
    if (reach_[m] == 0) reach_[m] = 1;
    const float moved = std::abs(readings[m].angle_rad) / configured_rad[m];
    if (options.enabled && readings[m].measured && moved > kMovesFar) {
      reach_[m] += kSpeed * dt_s * (moved > reach_[m] ? kPercentile : kPercentile - 1);
      reach_[m] = std::clamp(reach_[m], options.least, options.most);
    }
    range_rad_[m] = configured_rad[m] * (options.enabled ? reach_[m] * (carrying() ? options.carrying : 1) : 1);
  }
  return range_rad_;
}

}  // namespace armature
