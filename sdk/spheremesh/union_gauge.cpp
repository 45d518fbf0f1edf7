#include "sdk/spheremesh/union_gauge.h"

#include <algorithm>
#include <cassert>

#include "sdk/spheremesh/gauge_lanes.h"
#include "sdk/spheremesh/point_blocks.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

std::uint32_t index_of(SphereId id) noexcept {
  return static_cast<std::uint32_t>(id.index());
}

// The same operations with wider registers where the processor has them: the same results.
// (Programs end before main where the thread sanitizer instruments what chooses between them.)
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__)
#define ARMATURE_LANES __attribute__((target_clones("avx2", "default")))
#else
#define ARMATURE_LANES
#endif

struct LeastLanes {
  alignas(64) Lanes distance, piece, b, c;
};

double largest(const Lanes& lanes) noexcept {
  double most = lanes[0];
  for (const double x : lanes) most = std::max(most, x);
  return most;
}

/// The nearest piece of each point; pieces as numbers, so that all lanes are of a kind.
ARMATURE_LANES void find_least(const std::vector<NearbyPieces::Entry>& entries, const std::vector<EdgeGauge>& edges,
                               const std::vector<FacetGauge>& facets, const PointLanes& points,
                               LeastLanes& least) noexcept {
  alignas(64) Lanes d, b, c{};
  least.distance.fill(std::numeric_limits<double>::infinity());
  least.piece.fill(0), least.b.fill(0), least.c.fill(0);
  for (const auto& [bound, piece] : entries) {
    if (bound - points.reach >= largest(least.distance)) break;
    if (piece < edges.size())
      distances(edges[piece], points, d, b);
    else if (facets[piece - edges.size()].exists)
      distances(facets[piece - edges.size()], points, d, b, c);
    else
      continue;
    const auto number = static_cast<double>(piece);
    LeastLanes now = least;
    for (std::size_t k = 0; k < kLanes; ++k) {
      now.piece[k] = d[k] < now.distance[k] ? number : now.piece[k];
      now.b[k] = d[k] < now.distance[k] ? b[k] : now.b[k];
      now.c[k] = d[k] < now.distance[k] ? c[k] : now.c[k];
      now.distance[k] = d[k] < now.distance[k] ? d[k] : now.distance[k];
    }
    least = now;
  }
}

/// The least distances, as long as some are not below `enough`.
ARMATURE_LANES void find_cover(const std::vector<NearbyPieces::Entry>& entries, const std::vector<EdgeGauge>& edges,
                               const std::vector<FacetGauge>& facets, const PointLanes& points, double enough,
                               Lanes& least) noexcept {
  alignas(64) Lanes d, b, c;
  least.fill(enough);
  for (const auto& [bound, piece] : entries) {
    if (bound - points.reach >= enough) break;
    if (piece < edges.size())
      distances(edges[piece], points, d, b);
    else if (facets[piece - edges.size()].exists)
      distances(facets[piece - edges.size()], points, d, b, c);
    else
      continue;
    for (std::size_t k = 0; k < kLanes; ++k) least[k] = d[k] < least[k] ? d[k] : least[k];
    if (largest(least) < enough) break;
  }
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
  return touch_of(nearest, least, along_or_b, weight_c);
}

UnionTouch UnionGauge::touch_of(std::uint32_t piece, double distance, double b, double c) const noexcept {
  const auto edge_count = static_cast<std::uint32_t>(edges_.size());
  if (piece >= edge_count) return {distance, piece, facet_corners_[piece - edge_count], {1 - b - c, b, c}};
  const double t = edges_[piece].blend(b);
  const auto& ends = edge_corners_[piece];
  return {distance, piece, {ends[0], ends[1], ends[1]}, {1 - t, t, 0}};
}

void UnionGauge::touch(const NearbyPieces& pieces, std::span<const Vector3d> points, std::span<UnionTouch> out) const {
  const PointLanes lanes(points, pieces.centre);
  LeastLanes least;
  find_least(pieces.entries, edges_, facets_, lanes, least);
  for (std::size_t k = 0; k < points.size(); ++k)
    out[k] = touch_of(static_cast<std::uint32_t>(least.piece[k]), least.distance[k], least.b[k], least.c[k]);
}

void UnionGauge::covers(const NearbyPieces& pieces, std::span<const Vector3d> points, double depth,
                        std::span<char> out) const {
  const PointLanes lanes(points, pieces.centre);
  Lanes least;
  find_cover(pieces.entries, edges_, facets_, lanes, -depth, least);
  for (std::size_t k = 0; k < points.size(); ++k) out[k] = least[k] < -depth ? 1 : 0;
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
    gauge.touch(pieces, points.subspan(begin, end - begin), out.subspan(begin, end - begin));
  });
}

}  // namespace armature::sdk
