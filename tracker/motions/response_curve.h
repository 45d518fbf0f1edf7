#pragma once

#include <cmath>

namespace armature {

/// From the angle that a model's joints show to the one that a person turned, bent or leaned by: odd, continuous and
/// monotone. Joints that are means over many poses show less of a motion than there is, and of a small one less than
/// of a large one. Both factors are positive. Realtime-safe: yes.
struct ResponseCurve {
  float knee_rad = 1;  ///< where the slope changes: an angle of the person
  float near = 1;      ///< shown angles times this, up to the knee
  float far = 1;       ///< and what is beyond it times this

  [[nodiscard]] float true_angle(float shown_rad) const noexcept {
    const float angle = near * std::abs(shown_rad);
    const float out = angle <= knee_rad ? angle : knee_rad + far / near * (angle - knee_rad);
    return std::copysign(out, shown_rad);
  }
  /// The inverse.
  [[nodiscard]] float shown_angle(float true_rad) const noexcept {
    const float angle = std::abs(true_rad);
    const float out = angle <= knee_rad ? angle / near : knee_rad / near + (angle - knee_rad) / far;
    return std::copysign(out, true_rad);
  }
};

}  // namespace armature
