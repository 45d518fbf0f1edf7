#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <armature/sdk/distance/sphere_mesh_tree.h>
#include <armature/sdk/spheremesh/sphere_mesh.h>

#include "sdk/distance/bvh.h"
#include "sdk/spheremesh/gauges.h"

namespace armature::sdk {

/// A piece of a sphere-mesh that distances are taken to: the inside of a triangle, or an edge. A triangle's edges cover
/// what its inside does not; a sphere on no edge is an edge of no length.
struct Piece {
  enum class Kind : std::uint8_t { Edge, Facet };
  Kind kind = Kind::Edge;
  std::uint32_t index = 0;
};

/// A sphere-mesh taken apart: every edge once, every triangle that has facets.
struct SpherePieces {
  std::vector<Sphere> spheres;
  std::vector<EdgeGauge> edges;
  std::vector<std::array<SphereId, 2>> edge_spheres;  ///< the second not valid for a sphere alone
  std::vector<FacetGauge> facets;
  std::vector<SphereTriple> facet_spheres;
  Eigen::Vector3d lower = Eigen::Vector3d::Zero(), upper = Eigen::Vector3d::Zero();  ///< the bounding box

  SpherePieces() = default;
  explicit SpherePieces(const SphereMesh& shape);

  [[nodiscard]] std::vector<Piece> all() const;
  [[nodiscard]] TouchedSpheres spheres_of(Piece piece) const noexcept {
    if (piece.kind == Piece::Kind::Facet) return facet_spheres[piece.index];
    return {edge_spheres[piece.index][0], edge_spheres[piece.index][1], SphereId()};
  }
  [[nodiscard]] const Sphere& sphere(SphereId id) const noexcept { return spheres[id.index()]; }
  [[nodiscard]] UnitFrame frame() const noexcept { return UnitFrame(lower, upper); }
  /// The box of the hull of a piece's spheres.
  [[nodiscard]] UnitBox box_of(const UnitFrame& frame, Piece piece) const noexcept;
};

/// A signed distance to one piece, and the place of the touched sphere.
struct PieceDistance {
  double distance = std::numeric_limits<double>::infinity();
  Piece piece = {};
  double b = 0, c = 0;  ///< how far along an edge; the weights of the second and third sphere of a triangle
};

/// Infinite where the touched sphere of a triangle lies on its edges, which are pieces of their own.
[[nodiscard]] inline PieceDistance distance_to(const SpherePieces& shape, Piece piece,
                                               const Eigen::Vector3d& point) noexcept {
  PieceDistance d;
  d.piece = piece;
  if (piece.kind == Piece::Kind::Edge) {
    d.distance = shape.edges[piece.index].distance(point, d.b);
  } else if (!shape.facets[piece.index].distance(point, d.distance, d.b, d.c)) {
    d.distance = std::numeric_limits<double>::infinity();
  }
  return d;
}

/// The outward normal at the touched sphere.
[[nodiscard]] inline Eigen::Vector3d normal_at(const SpherePieces& shape, const PieceDistance& found,
                                               const Eigen::Vector3d& point) noexcept {
  if (found.piece.kind == Piece::Kind::Edge) return shape.edges[found.piece.index].normal(point, found.b);
  const FacetGauge& facet = shape.facets[found.piece.index];
  return facet.normal(facet.n.dot(point - facet.a) < 0 ? -1 : 1);
}

/// Weights of the spheres of the piece in the touched sphere.
[[nodiscard]] inline Eigen::Vector3d weights_at(const SpherePieces& shape, const PieceDistance& found) noexcept {
  if (found.piece.kind == Piece::Kind::Facet) return {1 - found.b - found.c, found.b, found.c};
  const double blend = shape.edges[found.piece.index].blend(found.b);
  return {1 - blend, blend, 0};
}

}  // namespace armature::sdk
