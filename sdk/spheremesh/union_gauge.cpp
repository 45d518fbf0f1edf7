#include "sdk/spheremesh/union_gauge.h"

#include <algorithm>
#include <cassert>

#include "sdk/spheremesh/point_blocks.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

std::uint32_t index_of(SphereId id) noexcept {
  return static_cast<std::uint32_t>(id.index());
}

}  // namespace

UnionGauge::UnionGauge(const SphereMesh& shape) {
  edge_corners_.reserve(shape.edges.size() + 3 * shape.triangles.size());
  const auto add = [&](SphereId a, SphereId b) { edge_corners_.push_back({index_of(a), index_of(b)}); };
  for (const auto& [a, b] : shape.edges) add(a, b);
  facet_corners_.reserve(shape.triangles.size());
  for (const auto& [a, b, c] : shape.triangles) {
    add(a, b), add(b, c), add(a, c);
    facet_corners_.push_back({index_of(a), index_of(b), index_of(c)});
  }
  std::vector<bool> on_edge(shape.spheres.size(), false);
  for (const auto& ends : edge_corners_)
    for (const std::uint32_t end : ends) on_edge[end] = true;
  for (std::uint32_t k = 0; k < on_edge.size(); ++k)
    if (!on_edge[k]) edge_corners_.push_back({k, k});
  std::sort(edge_corners_.begin(), edge_corners_.end());
  edge_corners_.erase(std::unique(edge_corners_.begin(), edge_corners_.end()), edge_corners_.end());
  edges_.resize(edge_corners_.size());
  facets_.resize(facet_corners_.size());
  move_to(shape.spheres);
}

void UnionGauge::move_to(std::span<const Sphere> spheres) {
  spheres_.assign(spheres.begin(), spheres.end());
  for (std::size_t e = 0; e < edges_.size(); ++e)
    edges_[e] = EdgeGauge({spheres_[edge_corners_[e][0]], spheres_[edge_corners_[e][1]]});
  for (std::size_t f = 0; f < facets_.size(); ++f) {
    const auto& [a, b, c] = facet_corners_[f];
    facets_[f] = FacetGauge({spheres_[a], spheres_[b], spheres_[c]});
  }
}

NearbyPieces UnionGauge::all() const {
  NearbyPieces pieces;
  pieces.edges.resize(edges_.size());
  pieces.facets.resize(facets_.size());
  for (std::uint32_t k = 0; k < edges_.size(); ++k) pieces.edges[k] = k;
  for (std::uint32_t k = 0; k < facets_.size(); ++k) pieces.facets[k] = k;
  return pieces;
}

void UnionGauge::near(const NearbyPieces& among, const Vector3d& centre, double radius, double within,
                      NearbyPieces& out) const {
  // Signed distances to pieces grow by at most 1 per length: what is farther than the nearest one by more than the
  // ball's diameter is nearest nowhere in it.
  thread_local std::vector<double> distances;
  distances.resize(among.edges.size());
  double least = std::numeric_limits<double>::infinity();
  double along = 0;
  double b = 0;
  double c = 0;
  double d = 0;
  for (std::size_t k = 0; k < among.edges.size(); ++k) {
    distances[k] = edges_[among.edges[k]].distance(centre, along);
    least = std::min(least, distances[k]);
  }
  for (const std::uint32_t f : among.facets)
    if (facets_[f].distance(centre, d, b, c)) least = std::min(least, d);
  const double limit = std::min(least + 2 * radius, within + radius);

  out.edges.clear();
  out.facets.clear();
  for (std::size_t k = 0; k < among.edges.size(); ++k)
    if (distances[k] <= limit) out.edges.push_back(among.edges[k]);
  for (const std::uint32_t f : among.facets) {
    const FacetGauge& facet = facets_[f];
    if (!facet.exists) continue;
    static_cast<void>(facet.distance(centre, d, b, c));
    if (d > limit) continue;
    const double slack_b = radius * (facet.to_b.norm() + std::abs(facet.lean_b));
    const double slack_c = radius * (facet.to_c.norm() + std::abs(facet.lean_c));
    if (b >= -slack_b && c >= -slack_c && b + c <= 1 + slack_b + slack_c) out.facets.push_back(f);
  }
}

UnionTouch UnionGauge::touch(const NearbyPieces& pieces, const Vector3d& point) const noexcept {
  UnionTouch best;
  for (const std::uint32_t e : pieces.edges) {
    double along = 0;
    const double d = edges_[e].distance(point, along);
    if (!(d < best.distance)) continue;
    const double t = edges_[e].blend(along);
    const auto& ends = edge_corners_[e];
    best = {d, e, {ends[0], ends[1], ends[1]}, {1 - t, t, 0}};
  }
  for (const std::uint32_t f : pieces.facets) {
    double d = 0;
    double b = 0;
    double c = 0;
    if (!facets_[f].distance(point, d, b, c) || !(d < best.distance)) continue;
    best = {d, static_cast<std::uint32_t>(edges_.size()) + f, facet_corners_[f], {1 - b - c, b, c}};
  }
  return best;
}

double UnionGauge::distance(const NearbyPieces& pieces, const Vector3d& point, double enough) const noexcept {
  double least = std::numeric_limits<double>::infinity();
  double unused = 0;
  for (const std::uint32_t e : pieces.edges) {
    least = std::min(least, edges_[e].distance(point, unused));
    if (least < enough) return least;
  }
  for (const std::uint32_t f : pieces.facets) {
    double d = 0;
    double b = 0;
    double c = 0;
    if (!facets_[f].distance(point, d, b, c)) continue;
    least = std::min(least, d);
    if (least < enough) return least;
  }
  return least;
}

Sphere blend(std::span<const Sphere> spheres, const Corners& corners, const std::array<double, 3>& weights) noexcept {
  Sphere sphere;
  for (std::size_t k = 0; k < 3; ++k) {
    sphere.centre += weights[k] * spheres[corners[k]].centre;
    sphere.radius += weights[k] * spheres[corners[k]].radius;
  }
  return sphere;
}

void touch_all(const UnionGauge& gauge, std::span<const Vector3d> points, std::span<UnionTouch> out) {
  assert(points.size() == out.size());
  constexpr double kAnywhere = std::numeric_limits<double>::infinity();
  for_each_block(gauge, points, kAnywhere, [&](const NearbyPieces& pieces, std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) out[k] = gauge.touch(pieces, points[k]);
  });
}

}  // namespace armature::sdk
