#pragma once

#include <Eigen/Core>

namespace armature::sdk {

/// Whether every coordinate can be worked with: products of five of them, as in sums of quadrics, stay finite.
[[nodiscard]] inline bool in_range(const Eigen::Vector3d& point) noexcept {
  constexpr double kFarthest = 1e60;
  return (point.array().abs() < kFarthest).all();
}

}  // namespace armature::sdk
