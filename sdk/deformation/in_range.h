#pragma once

#include <Eigen/Core>

namespace armature::sdk {

/// Whether every coordinate can be worked with: products of seven of them, as in fits of spheres, stay finite.
[[nodiscard]] inline bool in_range(const Eigen::Vector3d& point) noexcept {
  constexpr double kFarthest = 1e40;
  return (point.array().abs() < kFarthest).all();
}

}  // namespace armature::sdk
