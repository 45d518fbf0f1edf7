#pragma once

#include <span>

#include <Eigen/Core>

namespace armature::sdk {

/// A ball around points.
struct EnclosingBall {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0;
};

/// The smallest ball that holds all points, to rounding; empty about the origin for none.
[[nodiscard]] EnclosingBall smallest_enclosing_ball(std::span<const Eigen::Vector3d> points);

}  // namespace armature::sdk
