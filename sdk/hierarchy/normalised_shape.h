#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/mesh/mesh.h>

namespace armature::sdk {

/// A mesh moved and scaled to a bounding box about the origin with a diagonal of 1 (unscaled if it has none), every
/// component's triangles outward.
struct NormalisedShape {
  std::vector<Eigen::Vector3d> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< of the bounding box's middle in the model's coordinates
  double scale = 1;                                  ///< the diagonal

  /// Outward is judged for each component by the sign of its volume; one that is inside out is turned unless something
  /// encloses it: then it is the inner wall of a shell.
  [[nodiscard]] static NormalisedShape of(const Mesh& mesh);
};

}  // namespace armature::sdk
