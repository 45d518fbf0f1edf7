#pragma once

#include <vector>

#include <armature/sdk/distance/sphere_mesh_tree.h>

#include "sdk/distance/sphere_pieces.h"

namespace armature::sdk {

/// The pieces of a sphere-mesh and their boxes, which an OuterSurface of it looks through as well.
struct SphereMeshTree::State {
  SpherePieces shape;
  std::vector<Piece> pieces;  ///< in the order of the leaves
  UnitFrame frame;
  Bvh bvh;

  /// Looks for the least signed distance and stops early once it is below `enough`.
  [[nodiscard]] PieceDistance find(const Eigen::Vector3d& point, double enough) const noexcept;
};

}  // namespace armature::sdk
