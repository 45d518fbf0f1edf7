#pragma once

#include <cmath>
#include <numbers>

#include "tracker/motions/motion_options.h"

namespace armature {

/// One-Euro filter of one signal (Casiez, Roussel and Vogel 2012). Realtime-safe: yes.
class OneEuro {
 public:
  void reset() noexcept { started_ = false; }

  /// The filtered value; `dt_s` > 0 is the time since the last call and does not matter in the first.
  float filter(float value, float dt_s, const OneEuroOptions& options) noexcept {
    if (!started_) {
      started_ = true;
      value_ = value;
      speed_ = 0;
      return value_;
    }
    speed_ += smoothing(options.derivative_cutoff_hz, dt_s) * ((value - value_) / dt_s - speed_);
    const float cutoff_hz = options.min_cutoff_hz + options.speed_coefficient * std::abs(speed_);
    value_ += smoothing(cutoff_hz, dt_s) * (value - value_);
    return value_;
  }

  [[nodiscard]] float value() const noexcept { return value_; }

 private:
  static float smoothing(float cutoff_hz, float dt_s) noexcept {
    const float r = 2 * std::numbers::pi_v<float> * cutoff_hz * dt_s;
    return r / (r + 1);
  }

  bool started_ = false;
  float value_ = 0;
  float speed_ = 0;
};

}  // namespace armature
