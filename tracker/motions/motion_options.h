#pragma once

#include <chrono>
#include <numbers>

#include "tracker/motions/motion.h"
#include "tracker/motions/response_curve.h"

namespace armature {

[[nodiscard]] constexpr float radians(float degrees) noexcept {
  return degrees * std::numbers::pi_v<float> / 180;
}

/// One-Euro filter (Casiez et al. 2012): a low-pass whose cutoff rises with the speed of the signal.
struct OneEuroOptions {
  float min_cutoff_hz = 1.2F;         ///< at rest: lower is calmer and later
  float speed_coefficient = 3.0F;     ///< the paper's beta, Hz per rad/s: higher follows fast motion more closely
  float derivative_cutoff_hz = 3.0F;  ///< smooths the speed itself
  float noise_speed = 0;              ///< a speed up to this is noise and raises nothing
  bool lag_is_speed = true;           ///< whether being behind the signal counts as its speed; the paper's does not
};

/// The angle that counts as 1, in the order of MotionId. The source publishes none: these are ours, chosen so that the
/// full range is a comfortable motion (far below what the joint could do).
inline constexpr PerMotion<float> kDefaultRange_rad = {radians(35), radians(25), radians(30), radians(20),
                                                       radians(25), radians(12), radians(30), radians(30)};

/// By what the shipped model shows motions too small (ResponseCurve::near and far), as `armature bench steering`
/// measures it on synthetic people.
extern const PerMotion<float> kModelGain, kModelFarGain;
/// How much of each motion the shipped model's joints show as a rotation of the hips.
extern const PerMotion<float> kModelReadAsHips;

/// How motions are measured.
struct MotionOptions {
  PerMotion<float> range_rad = kDefaultRange_rad;
  /// What the angles that joints show are multiplied by, up to half of the default range and beyond. They belong to
  /// the model.
  PerMotion<float> gain = kModelGain;
  PerMotion<float> far_gain = kModelFarGain;
  /// How much of each motion's angle is taken off that of rotate_hips: votes draw hips along with what is above them.
  /// Belongs to the model.
  PerMotion<float> read_as_hips = kModelReadAsHips;
  OneEuroOptions filter;
  float min_confidence = 0.50F;              ///< below it a motion is not measured but held
  std::chrono::milliseconds hold_time{150};  ///< how long it is held; afterwards it counts as zero

  [[nodiscard]] ResponseCurve curve(std::size_t motion) const noexcept {
    return {.knee_rad = kDefaultRange_rad[motion] / 2, .near = gain[motion], .far = far_gain[motion]};
  }
};

/// The same for joints that show motions as they are: true ones.
[[nodiscard]] inline MotionOptions of_true_joints(MotionOptions options) noexcept {
  options.gain.fill(1);
  options.far_gain.fill(1);
  options.read_as_hips.fill(0);
  return options;
}

}  // namespace armature
