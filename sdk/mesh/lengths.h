#pragma once

#include <cmath>

#include <Eigen/Core>

namespace armature::sdk {

/// Unit length, or zero for what has no direction: zero and what is not finite. Survives lengths whose square does not.
[[nodiscard]] inline Eigen::Vector3d direction_of(const Eigen::Vector3d& v) noexcept {
  const double largest = v.cwiseAbs().maxCoeff();
  if (!v.allFinite() || !(largest > 0)) return Eigen::Vector3d::Zero();
  return (v / largest).normalized();
}

/// A unit about as large as a length, in which powers of lengths stay numbers: a power of two, so that measuring in it
/// rounds nothing. 1 for what has no length.
[[nodiscard]] inline double unit_near(double length) noexcept {
  return length > 0 && std::isfinite(length) ? std::ldexp(1.0, std::ilogb(length)) : 1;
}

/// The length, bit by bit that of norm() where its square is a number.
[[nodiscard]] inline double length_of(const Eigen::Vector3d& v) noexcept {
  const double unit = unit_near(v.cwiseAbs().maxCoeff());
  return unit * (v / unit).norm();
}

}  // namespace armature::sdk
