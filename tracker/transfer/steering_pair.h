#pragma once

#include <optional>
#include <string>

#include "tracker/motions/motion.h"

namespace armature {

/// Which motion turns the view and which one walks (section 3.5.2).
struct SteeringPair {
  MotionId turn = MotionId::LeanBust;
  MotionId walk = MotionId::BendKnees;

  friend bool operator==(const SteeringPair&, const SteeringPair&) = default;
};

/// Section 3.5.2 found six pairs too correlated to be doable: rotate hips with translate hips, lean bust with bend
/// bust, bend knees with step, both ways. rotate_bust contains both rotations and shares rotate_hips' partner.
[[nodiscard]] bool correlated(const SteeringPair& pair) noexcept;

/// Why the pair cannot be steered with, or nothing: one motion for both, or correlated without being allowed.
[[nodiscard]] std::optional<std::string> refused(const SteeringPair& pair, bool allow_correlated);

}  // namespace armature
