#include "sdk/spheremesh/convex_union.h"

#include <algorithm>

#include <Eigen/Cholesky>

namespace armature::sdk {

using Eigen::Vector3d;

ConvexUnion::ConvexUnion(const SphereMesh& shape) : shape_(shape), frame_(shape_.frame()) {
  std::vector<bool> in_triangle(shape_.edges.size(), false);
  const auto edge_between = [&](SphereId a, SphereId b) {
    const std::array<SphereId, 2> pair{std::min(a, b), std::max(a, b)};
    // Pairs come sorted, spheres on no edge behind them.
    const auto end = std::find_if(shape_.edge_spheres.begin(), shape_.edge_spheres.end(),
                                  [](const auto& p) { return !p[1].valid(); });
    const auto place = std::lower_bound(shape_.edge_spheres.begin(), end, pair);
    return static_cast<std::uint32_t>(place - shape_.edge_spheres.begin());
  };
  std::vector<UnitBox> boxes;
  for (std::size_t k = 0; k < shape_.facets.size(); ++k) {
    const auto [a, b, c] = shape_.facet_spheres[k];
    const Piece facet{Piece::Kind::Facet, static_cast<std::uint32_t>(k)};
    std::array<Piece, 4> pieces{facet};
    std::size_t count = 1;
    for (const auto& [from, to] : {std::pair{a, b}, {b, c}, {a, c}}) {
      const std::uint32_t edge = edge_between(from, to);
      in_triangle[edge] = true;
      pieces[count++] = {Piece::Kind::Edge, edge};
    }
    bodies_.push_back(pieces);
    piece_count_.push_back(4);
    boxes.push_back(shape_.box_of(frame_, facet));
  }
  for (std::size_t k = 0; k < shape_.edges.size(); ++k) {
    if (in_triangle[k]) continue;
    const Piece edge{Piece::Kind::Edge, static_cast<std::uint32_t>(k)};
    bodies_.push_back({edge, edge, edge, edge});
    piece_count_.push_back(1);
    boxes.push_back(shape_.box_of(frame_, edge));
  }
  for (const auto& pieces : bodies_) {
    double least = std::numeric_limits<double>::infinity();
    for (const SphereId id : shape_.spheres_of(pieces[0]))
      if (id.valid()) least = std::min(least, shape_.sphere(id).radius);
    least_radius_.push_back(least);
  }
  bvh_ = Bvh(boxes, 4);
  order_ = bvh_.order();
}

PieceDistance ConvexUnion::least(BodyId body, const Vector3d& point) const noexcept {
  const auto& pieces = bodies_[body];
  PieceDistance nearest = distance_to(shape_, pieces[0], point);
  // The inside of a triangle is touched or its edges are, not both.
  if (std::isfinite(nearest.distance)) return nearest;
  for (std::size_t k = 1; k < piece_count_[body]; ++k)
    if (const PieceDistance d = distance_to(shape_, pieces[k], point); d.distance < nearest.distance) nearest = d;
  return nearest;
}

Vector3d ConvexUnion::to_crease(BodyId a, BodyId b, const Vector3d& point) const noexcept {
  const Value at_a = value(a, point);
  const Value at_b = value(b, point);
  Eigen::Matrix<double, 2, 3> slopes;
  slopes << at_a.gradient.transpose(), at_b.gradient.transpose();
  Eigen::Matrix2d normal = slopes * slopes.transpose();
  normal.diagonal().array() += 1e-9;  // planes that touch
  return -slopes.transpose() * normal.ldlt().solve(Eigen::Vector2d(at_a.distance, at_b.distance));
}

void ConvexUnion::find(const Vector3d& point, double reach, std::vector<BodyId>& bodies) const {
  const Eigen::Vector3f p = frame_.to_unit(point);
  const float limit = static_cast<float>(reach * frame_.scale) + Bvh::kSlack * (1 + p.cwiseAbs().maxCoeff());
  bvh_.descend(
      limit, [&](const Bvh::Node& node) { return signed_distances(node, p); },
      [&](std::size_t first, std::size_t count) {
        for (std::size_t k = first; k < first + count; ++k)
          if (distance(order_[k], point) <= reach) bodies.push_back(order_[k]);
        return limit;
      });
}

}  // namespace armature::sdk
