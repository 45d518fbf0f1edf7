#pragma once

#include <Eigen/Core>
#include <armature/sdk/descriptors/gls.h>

namespace armature::sdk {

/// What a fit needs of the points around a place, in coordinates about that place: sums over all of weight times 1, p,
/// n, p.n and p.p. Sums of two neighbourhoods about the same place add up to those of their union.
struct GlsSums {
  double weight = 0;
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Vector3d n = Eigen::Vector3d::Zero();
  double pn = 0;
  double pp = 0;

  GlsSums& operator+=(const GlsSums& other) noexcept;
  /// The same points about a place that lies `by` from the old one.
  [[nodiscard]] GlsSums about(const Eigen::Vector3d& by) const noexcept;
};

/// The sums that the fit at a place and scale is made of, about that place.
[[nodiscard]] GlsSums neighbourhood_sums(const GrowingLeastSquares& gls, const Eigen::Vector3d& place,
                                         std::size_t scale);

/// u_c + u_l.p + u_q p.p, 0 on the sphere.
struct AlgebraicSphere {
  double c = 0;
  Eigen::Vector3d l = Eigen::Vector3d::Zero();
  double q = 0;

  /// |u_l|^2 - 4 u_c u_q (Pratt 1987).
  [[nodiscard]] double norm2() const noexcept { return l.squaredNorm() - 4 * c * q; }
};

/// The sphere whose gradient fits the normals and which then passes nearest to the points (Guennebaud, Germann, Gross
/// 2008). A plane where the points do not spread.
[[nodiscard]] AlgebraicSphere fit_sphere(const GlsSums& sums) noexcept;
/// How it changes as the sums do, by `rate`.
[[nodiscard]] AlgebraicSphere fit_sphere_rate(const GlsSums& sums, const GlsSums& rate) noexcept;

/// The sphere as seen from the origin.
[[nodiscard]] Gls gls_of(const AlgebraicSphere& sphere) noexcept;

}  // namespace armature::sdk
