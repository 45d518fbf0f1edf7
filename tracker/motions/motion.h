#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace armature {

/// The seven motions of section 3.3.1 and rotate_bust, which merges the two rotations (section 3.6).
enum class MotionId : std::uint8_t {
  RotateShoulders,
  RotateHips,
  RotateBust,
  LeanBust,
  BendBust,
  TranslateHips,
  BendKnees,
  Step,
};
inline constexpr int kMotionCount = 8;

/// Motion names as configuration, wire and JSON spell them, in the order of MotionId.
inline constexpr std::array<std::string_view, kMotionCount> kMotionNames = {
    "rotate_shoulders", "rotate_hips", "rotate_bust", "lean_bust", "bend_bust", "translate_hips", "bend_knees", "step",
};

[[nodiscard]] constexpr std::size_t index(MotionId motion) noexcept {
  return static_cast<std::size_t>(motion);
}

/// One value a motion, in the order of MotionId.
template <class T>
using PerMotion = std::array<T, kMotionCount>;

}  // namespace armature
