#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/spheremesh/spherical_quadric.h>

namespace armature::sdk {

/// The plane of a triangle, for its three corners.
struct CellPlane {
  Eigen::Vector3d normal;  ///< N / 3
  Eigen::Vector3d unit;    ///< N / |N|, or 0
  double size;             ///< |N| / 3
  [[nodiscard]] static CellPlane of(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                    const Eigen::Vector3d& c) noexcept;
};

/// What the quadric of a region is made of, summed over its faces: with N a face's normal twice as long as its area, p
/// a corner and g its middle. Relative to a point near the region.
struct PlaneSums {
  std::array<double, 6> nn{};  ///< N N' / |N|, the upper triangle row by row
  std::array<double, 3> n{};   ///< N
  double size = 0;             ///< |N|
  std::array<double, 3> nd{};  ///< N (N.p) / |N|
  double d = 0;                ///< N.p
  std::array<double, 3> g{};   ///< |N| g

  PlaneSums& operator+=(const PlaneSums& other) noexcept;
  /// Of the part of a triangle about its corner p, between the middles of its sides: a third of its area. The corners'
  /// sum is p + q + r.
  void add_cell(const CellPlane& plane, const Eigen::Vector3d& p, const Eigen::Vector3d& sum) noexcept;
  /// Of the whole: planes weigh as their areas, and `regularise` times the integral of |q - x|^2 is added. Its constant
  /// part is left out.
  [[nodiscard]] SphericalQuadric quadric(double regularise) const noexcept;
  /// The area.
  [[nodiscard]] double weight() const noexcept { return size / 2; }
};

/// Of whole triangles, whose corners are numbers of `points`, relative to `origin`.
[[nodiscard]] PlaneSums sum_of(std::span<const std::array<std::uint32_t, 3>> triangles,
                               const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& origin) noexcept;

}  // namespace armature::sdk
