#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "sdk/spheremesh/convex_union.h"

namespace armature::sdk {

/// What lies within a distance of the surface of a union of convex bodies.
class SurfaceBand {
 public:
  SurfaceBand(const ConvexUnion& bodies, double distance) : bodies_(bodies), distance_(distance) {}

  using Corners = std::array<Eigen::Vector3d, 3>;

  /// Whether all of a triangle does, to a tenth of the distance. No point of it is farther outside than a body is from
  /// the worst corner, whose distance is convex; or farther inside one than the tangent plane to its middle says. Where
  /// that does not settle it the triangle is quartered.
  [[nodiscard]] bool holds(const Corners& triangle);

 private:
  [[nodiscard]] bool holds(const Corners& triangle, std::size_t first);
  /// Whether a point inside a body comes out of all bodies within the distance.
  [[nodiscard]] bool comes_out(const Eigen::Vector3d& point, std::size_t first) const;

  const ConvexUnion& bodies_;
  double distance_;
  std::vector<ConvexUnion::BodyId> near_;  // a stack: those of a quarter lie behind those of its triangle
};

}  // namespace armature::sdk
