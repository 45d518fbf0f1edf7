#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/spheremesh/sphere_mesh.h>

#include "sdk/spheremesh/gauges.h"

namespace armature::sdk {

/// The corners of a piece; where there are fewer than three the last one is repeated with weight 0.
using Corners = std::array<std::uint32_t, 3>;

/// The interpolated sphere that comes nearest to a point, of all pieces of a union.
struct UnionTouch {
  double distance = std::numeric_limits<double>::infinity();  ///< to that piece's surface, negative inside
  std::uint32_t piece = 0;                                    ///< an edge, or edge_count() + a facet
  Corners corners{};
  std::array<double, 3> weights{};
};

/// Pieces that points of a ball may touch: few of many, the nearest to its centre first.
struct NearbyPieces {
  struct Entry {
    double distance;      ///< from the centre, or less
    std::uint32_t piece;  ///< as UnionTouch names it
  };
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  std::vector<Entry> entries;
};

/// A sphere-mesh prepared for the distances of many points, block by block of points that lie close together. Unlike a
/// tree it costs next to nothing to follow spheres that move.
class UnionGauge {
 public:
  explicit UnionGauge(const SphereMesh& shape);

  /// The same connectivity with other spheres.
  void move_to(std::span<const Sphere> spheres);

  /// Whether both are of the same spheres and the same connectivity.
  [[nodiscard]] bool operator==(const UnionGauge& other) const noexcept;

  [[nodiscard]] const std::vector<Sphere>& spheres() const noexcept { return spheres_; }
  [[nodiscard]] const std::vector<EdgeGauge>& edges() const noexcept { return edges_; }
  [[nodiscard]] const std::vector<FacetGauge>& facets() const noexcept { return facets_; }
  [[nodiscard]] std::size_t edge_count() const noexcept { return edges_.size(); }
  /// A sphere on no edge counts as an edge whose ends are the same.
  [[nodiscard]] const std::array<std::uint32_t, 2>& edge_corners(std::size_t edge) const noexcept {
    return edge_corners_[edge];
  }
  /// The edge with these ends, which must exist.
  [[nodiscard]] std::size_t edge_between(std::uint32_t a, std::uint32_t b) const noexcept {
    const std::array ends{std::min(a, b), std::max(a, b)};
    return static_cast<std::size_t>(std::lower_bound(edge_corners_.begin(), edge_corners_.end(), ends) -
                                    edge_corners_.begin());
  }
  [[nodiscard]] const Corners& facet_corners(std::size_t facet) const noexcept { return facet_corners_[facet]; }

  /// Every piece.
  [[nodiscard]] NearbyPieces all() const;
  /// Of `among`, the pieces that can be the nearest to a point of a ball, or come nearer than `within` to one.
  void near(const NearbyPieces& among, const Eigen::Vector3d& centre, double radius, double within,
            NearbyPieces& out) const;

  /// The nearest of these pieces.
  [[nodiscard]] UnionTouch touch(const NearbyPieces& pieces, const Eigen::Vector3d& point) const noexcept;
  /// That for each of a few points, at most kLanes.
  void touch(const NearbyPieces& pieces, std::span<const Eigen::Vector3d> points, std::span<UnionTouch> out) const;
  /// The least signed distance to these pieces, but no more than `below`; if it is less than `enough`, any that is.
  [[nodiscard]] double distance(const NearbyPieces& pieces, const Eigen::Vector3d& point, double below,
                                double enough) const noexcept;
  /// Which of a few points, at most kLanes, lie deeper than `depth` within one of these pieces: 1, others 0.
  void covers(const NearbyPieces& pieces, std::span<const Eigen::Vector3d> points, double depth,
              std::span<char> out) const;

 private:
  /// The touch of a piece, where `b` and `c` are as below.
  [[nodiscard]] UnionTouch touch_of(std::uint32_t piece, double distance, double b, double c) const noexcept;
  /// The distance of a piece's surface from a point, and the interpolated sphere it is of: `b` is how far along an
  /// edge, or the weights of the second and third corner are `b` and `c`. False for a facet that is not above or below
  /// it.
  bool distance_to(std::uint32_t piece, const Eigen::Vector3d& point, double& distance, double& b,
                   double& c) const noexcept {
    if (piece >= edges_.size()) return facets_[piece - edges_.size()].distance(point, distance, b, c);
    distance = edges_[piece].distance(point, b);
    return true;
  }
  std::vector<Sphere> spheres_;
  std::vector<EdgeGauge> edges_;
  std::vector<std::array<std::uint32_t, 2>> edge_corners_;
  std::vector<FacetGauge> facets_;
  std::vector<Corners> facet_corners_;
};

/// The interpolated sphere with these weights.
[[nodiscard]] Sphere blend(std::span<const Sphere> spheres, const Corners& corners,
                           const std::array<double, 3>& weights) noexcept;

/// The nearest interpolated sphere for each point, on all cores. Points that follow one another should lie close.
void touch_all(const UnionGauge& gauge, std::span<const Eigen::Vector3d> points, std::span<UnionTouch> out);

}  // namespace armature::sdk
