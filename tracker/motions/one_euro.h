#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Core>

#include "tracker/motions/motion_options.h"

namespace armature {

/// One-Euro filter (Casiez, Roussel and Vogel 2012) of a number, or of a point in space whose speed is that of all its
/// coordinates together. Realtime-safe: yes.
template <class Value>
class BasicOneEuro {
 public:
  void reset() noexcept { started_ = false; }

  /// The filtered value; `dt_s` > 0 is the time since the last call and does not matter in the first.
  Value filter(const Value& value, float dt_s, const OneEuroOptions& options) noexcept {
    if (!started_) {
      started_ = true;
      value_ = last_ = value;
      speed_ = 0 * value;
      return value_;
    }
    const Value& before = options.lag_is_speed ? value_ : last_;
    speed_ += smoothing(options.derivative_cutoff_hz, dt_s) * ((value - before) / dt_s - speed_);
    last_ = value;
    const float cutoff_hz =
        options.min_cutoff_hz + options.speed_coefficient * std::max(0.0F, magnitude(speed_) - options.noise_speed);
    value_ += smoothing(cutoff_hz, dt_s) * (value - value_);
    return value_;
  }

  [[nodiscard]] const Value& value() const noexcept { return value_; }

 private:
  static float smoothing(float cutoff_hz, float dt_s) noexcept {
    const float r = 2 * std::numbers::pi_v<float> * cutoff_hz * dt_s;
    return r / (r + 1);
  }

  static float magnitude(float v) noexcept { return std::abs(v); }
  static float magnitude(const Eigen::Vector3f& v) noexcept { return v.norm(); }

  bool started_ = false;
  Value value_{};
  Value last_{};  // before the filter
  Value speed_{};
};

using OneEuro = BasicOneEuro<float>;
using PointOneEuro = BasicOneEuro<Eigen::Vector3f>;

}  // namespace armature
