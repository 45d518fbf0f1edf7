#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/mesh/ids.h>

namespace armature::sdk {

/// The corners of a face, counter-clockwise seen from outside.
using Triangle = std::array<VertexId, 3>;

/// Red, green, blue.
using Colour = std::array<std::uint8_t, 3>;

/// A triangle mesh as indexed arrays. Any length unit, any frame. It may be open, non-manifold, degenerate, or inside
/// out: `analyse()` tells. What every function here relies on: corners name positions, and positions are finite; the
/// readers guarantee it, `validate()` checks it.
struct Mesh {
  std::vector<Eigen::Vector3d> positions = {};  ///< by VertexId
  std::vector<Triangle> triangles = {};         ///< by FaceId
  std::vector<Colour> vertex_colours = {};      ///< by VertexId, or empty
  std::vector<Colour> face_colours = {};        ///< by FaceId, or empty

  /// Where a vertex lies.
  [[nodiscard]] const Eigen::Vector3d& position(VertexId vertex) const noexcept { return positions[vertex.index()]; }
  /// The corners of a face.
  [[nodiscard]] const Triangle& triangle(FaceId face) const noexcept { return triangles[face.index()]; }
  /// The position of a corner (0, 1 or 2) of a face.
  [[nodiscard]] const Eigen::Vector3d& corner(FaceId face, std::size_t k) const noexcept {
    return positions[triangles[face.index()][k].index()];
  }
};

}  // namespace armature::sdk
