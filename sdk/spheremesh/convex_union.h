#pragma once

#include <array>
#include <vector>

#include "sdk/distance/sphere_pieces.h"

namespace armature::sdk {

/// The primitives of a sphere-mesh as convex bodies. The signed distance to each is a convex function: below its value
/// at the corners of a tetrahedron inside that one, above its tangent plane everywhere.
class ConvexUnion {
 public:
  explicit ConvexUnion(const SphereMesh& shape);

  using BodyId = std::uint32_t;
  /// A body's signed distance at a point, and its gradient there.
  struct Value {
    double distance = std::numeric_limits<double>::infinity();
    Eigen::Vector3d gradient = Eigen::Vector3d::UnitZ();
  };

  [[nodiscard]] double distance(BodyId body, const Eigen::Vector3d& point) const noexcept {
    return least(body, point).distance;
  }
  [[nodiscard]] Value value(BodyId body, const Eigen::Vector3d& point) const noexcept {
    const PieceDistance found = least(body, point);
    return {found.distance, normal_at(shape_, found, point)};
  }
  /// The radius of the smallest sphere of a body.
  [[nodiscard]] double least_radius(BodyId body) const noexcept { return least_radius_[body]; }
  /// The least of some bodies.
  [[nodiscard]] double distance(const std::vector<BodyId>& bodies, const Eigen::Vector3d& point) const noexcept {
    double nearest = std::numeric_limits<double>::infinity();
    for (const BodyId body : bodies) nearest = std::min(nearest, distance(body, point));
    return nearest;
  }
  /// Which of some bodies, at least one, has the least.
  [[nodiscard]] BodyId nearest(const std::vector<BodyId>& bodies, const Eigen::Vector3d& point) const noexcept {
    BodyId nearest = bodies.front();
    double least = std::numeric_limits<double>::infinity();
    for (const BodyId body : bodies)
      if (const double d = distance(body, point); d < least) least = d, nearest = body;
    return nearest;
  }
  /// The way to the nearest point where the tangent planes of both bodies meet: a step of Newton's method towards the
  /// crease between them.
  [[nodiscard]] Eigen::Vector3d to_crease(BodyId a, BodyId b, const Eigen::Vector3d& point) const noexcept;
  /// Appends the bodies that come within `reach` of the point.
  void find(const Eigen::Vector3d& point, double reach, std::vector<BodyId>& bodies) const;

 private:
  [[nodiscard]] PieceDistance least(BodyId body, const Eigen::Vector3d& point) const noexcept;

  SpherePieces shape_;
  std::vector<std::array<Piece, 4>> bodies_;  // the pieces of each: a triangle's inside and edges, or an edge alone
  std::vector<std::uint8_t> piece_count_;
  std::vector<double> least_radius_;
  std::vector<BodyId> order_;  // of the leaves
  UnitFrame frame_;
  Bvh bvh_;
};

}  // namespace armature::sdk
