#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <armature/sdk/mesh/adjacency.h>
#include <armature/sdk/mesh/mesh.h>

namespace armature::sdk {

/// A side of a triangle: 3 * triangle + k is the one from corner k to corner k + 1.
using Side = std::uint32_t;

/// Triangles that know lengths instead of positions, glued side to side; closed and oriented. A triangle may be glued
/// to itself, and two vertices may share several edges.
///
/// Of a closed, oriented mesh whose edges have two faces each it holds every face once. Of any other it holds the
/// tufted cover (Sharp and Crane 2020): every face twice, front and back, glued around each edge in the order of
/// angles, and front to back on a boundary.
struct IntrinsicTriangulation {
  std::vector<std::array<std::uint32_t, 3>> corners = {};  ///< places of vertices in the mesh
  std::vector<double> lengths = {};                        ///< by Side
  std::vector<Side> glued = {};                            ///< by Side: the side that is the same edge
  int layers = 1;                                          ///< how often it holds every face: 1, or 2 in a cover

  /// Where a side begins.
  [[nodiscard]] std::uint32_t from(Side side) const noexcept { return corners[side / 3][side % 3]; }
  /// Where a side ends.
  [[nodiscard]] std::uint32_t to(Side side) const noexcept { return corners[side / 3][(side % 3 + 1) % 3]; }
};

/// Of a mesh. Faces that name a vertex twice are left out. Lengths are mollified (Sharp and Crane 2020, section 4.5):
/// the same amount is added to all of them, so that no triangle is thinner than a millionth of the mean length; nothing
/// where none is.
[[nodiscard]] IntrinsicTriangulation intrinsic_triangulation(const Mesh& mesh, const Adjacency& adjacency);

/// Flips edges until the triangulation is Delaunay, and returns the cotangents of the angles opposite its sides, by
/// Side: two that are glued sum up to zero at least, but for rounding.
[[nodiscard]] std::vector<double> flip_to_delaunay(IntrinsicTriangulation& triangulation);

/// The area of a triangle from its sides (Kahan's formula); 0 where they make none.
[[nodiscard]] double area_of_sides(double a, double b, double c) noexcept;

}  // namespace armature::sdk
