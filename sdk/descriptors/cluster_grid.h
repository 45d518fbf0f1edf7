#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>
#include <armature/sdk/mesh/point_set.h>

#include "sdk/descriptors/gls_fit.h"

namespace armature::sdk {

/// The points within a small cube summed up as one: their mean and what their sums about it are.
struct ClusterColumns {
  std::vector<double> x, y, z, nx, ny, nz, area, pn, pp;

  [[nodiscard]] std::size_t size() const noexcept { return x.size(); }
  void append(const ClusterColumns& others, std::size_t begin, std::size_t end);
  /// Appends those within a distance of a box.
  void append_near(const ClusterColumns& others, const Eigen::AlignedBox3d& box, double distance);
  void clear();
  /// Fills up to a multiple of `block` with clusters that weigh nothing.
  void pad(std::size_t block);
};

/// Clusters of points in cells as large as a scale, so that 27 of them hold every neighbourhood. Places are relative to
/// `origin`, so that sums keep their digits wherever the points lie.
class ClusterGrid {
 public:
  /// `cluster` is the side of the cubes that are summed up, 0 for none; `scale` is positive, and not so small that 2^20
  /// cells do not reach across the points. Points without normal or area are left out.
  ClusterGrid(const PointSet& points, const Eigen::Vector3d& origin, double scale, double cluster);

  using Cell = std::array<std::int32_t, 3>;
  [[nodiscard]] Cell cell_of(const Eigen::Vector3d& relative_place) const noexcept;
  /// Appends the clusters of the cells about one.
  void gather(const Cell& about, ClusterColumns& out) const;
  [[nodiscard]] double scale() const noexcept { return scale_; }

  /// A number that orders cells as the grid does; cells far outside share the rim's.
  [[nodiscard]] static std::uint64_t key(const Cell& cell) noexcept;

 private:
  double scale_;
  ClusterColumns clusters_;
  std::vector<std::uint64_t> keys_;    // of the cells that hold any, ascending
  std::vector<std::uint32_t> starts_;  // into clusters_, by cell, and its end
};

/// The sums of the clusters about a place with the weights of a scale. As many as a multiple of 4.
[[nodiscard]] GlsSums weighted_sums(const ClusterColumns& clusters, const Eigen::Vector3d& place,
                                    double scale) noexcept;
/// How these change with the place, about the same origin, and with the scale.
[[nodiscard]] std::array<GlsSums, 4> weighted_sum_rates(const ClusterColumns& clusters, const Eigen::Vector3d& place,
                                                        double scale) noexcept;

}  // namespace armature::sdk
