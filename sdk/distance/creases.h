#pragma once

#include <span>
#include <vector>

#include "sdk/distance/patches.h"

namespace armature::sdk {

/// A short straight piece of a crease: a curve where the surface of one primitive enters another.
struct CreaseSegment {
  Eigen::Vector3d a;
  Eigen::Vector3d b;
  std::uint32_t patch = 0;  ///< on which it was found
};

struct CreaseOptions {
  double resolution = 0;  ///< patches are searched in cells of this size, a length
  double chord = 0;       ///< how far segments may leave their curve, a length
};

/// The creases of the union on one patch, uncovered or not by primitives that hold the patch's own spheres. Cells of
/// the patch that lie wholly inside or outside of all other primitives are told by the distance at their middle
/// (distances change no faster than places) and left out; the rest is halved down to the resolution, where the curve
/// is marched and then halved until it is as straight as asked. What is smaller than a cell may be missed.
void find_creases(const SpherePieces& shape, std::span<const Piece> pieces, const Patch& patch,
                  const CreaseOptions& options, std::uint32_t patch_index, std::vector<CreaseSegment>& creases);

}  // namespace armature::sdk
