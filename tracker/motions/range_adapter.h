#pragma once

#include <chrono>

#include "tracker/body/skeleton.h"
#include "tracker/motions/motion_meter.h"

namespace armature {

/// How motion ranges follow the person (the thesis's future work). The values are ours.
struct AdaptationOptions {
  bool enabled = false;
  float least = 0.7F;      ///< of the configured range
  float most = 1.3F;       ///< of the configured range
  float carrying = 0.85F;  ///< and of that while something is carried before the body
};

/// The angle that counts as 1, for the person who steers: what she reaches when she moves far, which is the 90th
/// percentile of her angle beyond 40 % of the configured range. It moves slowly (2 % of the range for each second of
/// moving without reaching it, 18 % for each second beyond it) and within bounds. While a forearm is held bent before
/// the body (a mug, a phone, a bag on the arm) for two seconds, ranges are smaller. Realtime-safe: yes.
class RangeAdapter {
 public:
  /// Another person: nothing is known of her.
  void reset() noexcept;

  /// One tracked frame; the ranges in force from now on, radians.
  const PerMotion<float>& adapt(const PerMotion<MotionReading>& readings, const PerMotion<float>& configured_rad,
                                const Skeleton& skeleton, std::chrono::nanoseconds dt,
                                const AdaptationOptions& options) noexcept;

  [[nodiscard]] bool carrying() const noexcept { return bent_ >= kCarries; }

 private:
  static constexpr std::chrono::milliseconds kCarries{2000};

  PerMotion<float> reach_{};  ///< of the configured range; 0 = not known yet
  PerMotion<float> range_rad_{};
  std::chrono::nanoseconds bent_{0};
};

}  // namespace armature
