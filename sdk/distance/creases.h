#pragma once

#include <limits>
#include <span>
#include <vector>

#include <armature/sdk/distance/outer_surface.h>

#include "sdk/distance/patches.h"

namespace armature::sdk {

struct CreaseOptions {
  double resolution = 0;  ///< patches are searched in cells of this size, a length
  double chord = 0;       ///< how far segments may leave their curve, a length
  ///@{
  /// Only what comes so near to a place is looked for, a length.
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  double within = std::numeric_limits<double>::infinity();
  ///@}
};

/// The creases of the union on one patch, uncovered or not by primitives that hold the patch's own spheres. Cells of
/// the patch that lie wholly inside or outside of all other primitives are told by the distance at their middle
/// (distances change no faster than places) and left out; the rest is halved down to the resolution, where the curve
/// is marched and then halved until it is as straight as asked. What is smaller than a cell may be missed.
void find_creases(const SpherePieces& shape, std::span<const Piece> pieces, const Patch& patch,
                  const CreaseOptions& options, std::vector<OuterCrease>& creases);

}  // namespace armature::sdk
