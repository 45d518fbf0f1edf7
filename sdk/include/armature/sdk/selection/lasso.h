#pragma once

#include <variant>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/error.h>
#include <armature/sdk/mesh/ids.h>
#include <armature/sdk/selection/surface.h>

namespace armature::sdk {

/// Where all lines of sight meet (a perspective picture), in the mesh's frame and unit.
struct Eye {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< of the camera
};

/// The one direction of all lines of sight (a parallel picture), away from the viewer; of any length but 0.
struct Gaze {
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< in the mesh's frame
};

/// A loop that is drawn around something in a picture of the mesh.
struct Lasso {
  /// A point on each line of sight, near or far; the last is joined to the first.
  std::vector<Eigen::Vector3d> loop = {};
  std::variant<Eye, Gaze> seen_from = Eye{};  ///< where the lines of sight come from
  bool through = false;                       ///< takes what is hidden, too
};

/// The faces whose middles are seen inside the loop, ascending; where it crosses itself, all that it winds around.
/// Takes time in proportion to faces times points of the loop, on all cores. Refused: less than three points, points
/// that are not finite or lie at the eye or behind it, a gaze without a direction, a loop around nothing.
[[nodiscard]] Expected<std::vector<FaceId>> select_lasso(const Surface& surface, const Lasso& lasso);

}  // namespace armature::sdk
