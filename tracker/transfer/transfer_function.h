#pragma once

#include "tracker/motions/motion.h"

namespace armature {

/// The dead zone and the slope of section 3.4.2. The source publishes no values: these are ours.
struct TransferOptions {
  float alpha = 0.20F;  ///< dead zone as a share of the range, in [0, 0.9]
  float beta = 1.0F;    ///< slope: above 1 the motion starts gently, in [0.2, 5]
};

/// f(x) = 0 below alpha, ((x - alpha) / (1 - alpha))^beta above; x in [0, 1].
[[nodiscard]] float transfer(float x, float alpha, float beta) noexcept;

/// The largest dead zone that still leaves a motion worth steering with.
inline constexpr float kMaxDeadZone = 0.45F;

/// The dead zone that noise of this standard deviation (of the normalised, filtered value at rest) asks for: at least
/// alpha, at least four sigma.
[[nodiscard]] float dead_zone(float alpha, float sigma_normalized) noexcept;

/// One motion's way from a normalised value to a shaped one: symmetric about zero, with hysteresis. A motion becomes
/// active at the dead zone's edge and, while active, keeps a dead zone of 0.7 of it, so that noise at the edge does not
/// make it stutter. Realtime-safe: yes.
class ShapedMotion {
 public:
  void reset() noexcept { active_ = 0; }

  /// `value` in [-1, 1]; the result has its sign. A dead zone above kMaxDeadZone never becomes active.
  float shape(float value, float zone, float beta) noexcept;

  [[nodiscard]] bool active() const noexcept { return active_ != 0; }

 private:
  int active_ = 0;  // the sign of the active side, 0 = at rest
};

}  // namespace armature
