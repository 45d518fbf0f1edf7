#pragma once

#include <chrono>
#include <numbers>

#include "tracker/motions/motion.h"

namespace armature {

[[nodiscard]] constexpr float radians(float degrees) noexcept {
  return degrees * std::numbers::pi_v<float> / 180;
}

/// One-Euro filter (Casiez et al. 2012): a low-pass whose cutoff rises with the speed of the signal.
struct OneEuroOptions {
  float min_cutoff_hz = 1.2F;         ///< at rest: lower is calmer and later
  float speed_coefficient = 3.0F;     ///< the paper's beta, Hz per rad/s: higher follows fast motion more closely
  float derivative_cutoff_hz = 3.0F;  ///< smooths the speed itself
};

/// How motions are measured. The source publishes no ranges: these are ours, chosen so that the full range is a
/// comfortable motion (far below what the joint could do).
struct MotionOptions {
  /// The angle that counts as 1, in the order of MotionId, radians.
  PerMotion<float> range_rad = {radians(35), radians(25), radians(30), radians(20),
                                radians(25), radians(12), radians(30), radians(30)};
  /// What a measured angle is multiplied by. The votes of a forest are means over many poses, which makes motions look
  /// smaller than they are, in proportion; `armature bench steering` measures by how much, on synthetic people.
  /// These are of the shipped model, seeds 101 to 106; that of step is the one with the smallest 95th percentile, since
  /// a lifted foot makes it anything but proportional.
  PerMotion<float> gain = {1.24F, 1.63F, 1.40F, 1.72F, 1.04F, 1.72F, 1.26F, 0.85F};
  OneEuroOptions filter;
  float min_confidence = 0.15F;              ///< below it a motion is not measured but held
  std::chrono::milliseconds hold_time{150};  ///< how long it is held; afterwards it counts as zero
};

}  // namespace armature
