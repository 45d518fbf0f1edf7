#pragma once

#include <cmath>

#include <Eigen/Core>

namespace armature {

/// The C library computes sine and cosine by different code on different processors and differs in the last bit.
/// Rounded to this grid the results are the same, so synthetic images are the same bytes on every machine.
[[nodiscard]] inline double on_grid(double value) noexcept {
  return std::nearbyint(value * 0x1p26) * 0x1p-26;
}

/// Rotations of the body, radians, in axes x = left, y = up, z = forward; each positive as the motions are: forward,
/// to the person's left (counter-clockwise seen from above), to the person's left.
[[nodiscard]] inline Eigen::Matrix3d bent_forward(double angle) noexcept {
  const double c = on_grid(std::cos(angle)), s = on_grid(std::sin(angle));
  return Eigen::Matrix3d{{1, 0, 0}, {0, c, -s}, {0, s, c}};
}
[[nodiscard]] inline Eigen::Matrix3d turned_left(double angle) noexcept {
  const double c = on_grid(std::cos(angle)), s = on_grid(std::sin(angle));
  return Eigen::Matrix3d{{c, 0, s}, {0, 1, 0}, {-s, 0, c}};
}
[[nodiscard]] inline Eigen::Matrix3d leaned_left(double angle) noexcept {
  const double c = on_grid(std::cos(angle)), s = on_grid(std::sin(angle));
  return Eigen::Matrix3d{{c, s, 0}, {-s, c, 0}, {0, 0, 1}};
}

}  // namespace armature
