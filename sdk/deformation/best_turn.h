#pragma once

#include <Eigen/Core>

namespace armature::sdk {

/// The rotation that takes points x to y best, by S = sum of weighted (y - mean)(x - mean)' (Kabsch 1976). About
/// directions in which there is nothing to turn it does nothing.
[[nodiscard]] Eigen::Matrix3d best_turn(Eigen::Matrix3d S);

}  // namespace armature::sdk
