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

bool UnionGauge::operator==(const UnionGauge& other) const noexcept {
  const auto same = [](const Sphere& a, const Sphere& b) { return a.centre == b.centre && a.radius == b.radius; };
  return edge_corners_ == other.edge_corners_ && facet_corners_ == other.facet_corners_ &&
         std::equal(spheres_.begin(), spheres_.end(), other.spheres_.begin(), other.spheres_.end(), same);
}

NearbyPieces UnionGauge::all() const {
  NearbyPieces pieces;
  for (std::uint32_t k = 0; k < edges_.size() + facets_.size(); ++k)
    pieces.entries.push_back({-std::numeric_limits<double>::infinity(), k});
  return pieces;
}

void UnionGauge::near(const NearbyPieces& among, const Vector3d& centre, double radius, double within,
                      NearbyPieces& out) const {
  // Signed distances to pieces grow by at most 1 per length: what is farther than the nearest one by more than the
  // ball's diameter is nearest nowhere in it.
  const double offset = (centre - among.centre).norm();
  const auto edge_count = static_cast<std::uint32_t>(edges_.size());
  double least = std::numeric_limits<double>::infinity();
  out.centre = centre;
  out.entries.clear();
  for (const auto& [bound, piece] : among.entries) {
    const double limit = std::min(least + 2 * radius, within + radius);
    if (bound - offset > limit) break;
    double d = 0;
    double b = 0;
    double c = 0;
    if (piece < edge_count) {
      d = edges_[piece].distance(centre, b);
      least = std::min(least, d);
    } else {
      const FacetGauge& facet = facets_[piece - edge_count];
      if (!facet.exists) continue;
      if (facet.distance(centre, d, b, c)) {
        least = std::min(least, d);
      } else if (d <= limit) {
        const double slack_b = radius * facet.rate_b;
        const double slack_c = radius * facet.rate_c;
        if (!(b >= -slack_b && c >= -slack_c && b + c <= 1 + slack_b + slack_c)) continue;
      }
    }
    if (d <= limit) out.entries.push_back({d, piece});
  }
  const double limit = std::min(least + 2 * radius, within + radius);
  std::erase_if(out.entries, [&](const NearbyPieces::Entry& e) { return e.distance > limit; });
  std::sort(out.entries.begin(), out.entries.end(), [](const auto& x, const auto& y) {
    return x.distance < y.distance || (x.distance == y.distance && x.piece < y.piece);
  });
}

UnionTouch UnionGauge::touch(const NearbyPieces& pieces, const Vector3d& point) const noexcept {
  const double offset = (point - pieces.centre).norm();
  const auto edge_count = static_cast<std::uint32_t>(edges_.size());
  double least = std::numeric_limits<double>::infinity();
  std::uint32_t nearest = 0;
  double along_or_b = 0;
  double weight_c = 0;
  for (const auto& [bound, piece] : pieces.entries) {
    if (bound - offset >= least) break;
    double d = 0;
    double b = 0;
    double c = 0;
    if (!distance_to(piece, point, d, b, c)) continue;
    if (d < least) least = d, nearest = piece, along_or_b = b, weight_c = c;
  }
  if (nearest >= edge_count)
    return {least, nearest, facet_corners_[nearest - edge_count], {1 - along_or_b - weight_c, along_or_b, weight_c}};
  const double t = edges_[nearest].blend(along_or_b);
  const auto& ends = edge_corners_[nearest];
  return {least, nearest, {ends[0], ends[1], ends[1]}, {1 - t, t, 0}};
}

bool UnionGauge::covers(const NearbyPieces& pieces, const Vector3d& point, double depth) const noexcept {
  return distance(pieces, point, -depth, -depth) < -depth;
}

double UnionGauge::distance(const NearbyPieces& pieces, const Vector3d& point, double below,
                            double enough) const noexcept {
  const double offset = (point - pieces.centre).norm();
  double least = below;
  for (const auto& [bound, piece] : pieces.entries) {
    if (bound - offset >= least) break;
    double d = 0;
    double b = 0;
    double c = 0;
    if (!distance_to(piece, point, d, b, c)) continue;
    least = std::min(least, d);
    if (least < enough) break;
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
