#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>
#include <armature/sdk/spheremesh/primitives.h>

namespace armature::sdk {

/// The spherical quadric error metric (thesis, section 4.5; Thiery, Guy, Boubekeur 2013): the sum of weighted squared
/// signed distances n.(p - q) - r from a sphere s = (q, r) to oriented planes, as Q(s) = 1/2 s'As - b's + c. Sums of
/// quadrics are quadrics of unions. Coordinates should lie near the origin: c cancels what b's leaves.
struct SphericalQuadric {
  /// The upper triangle of A, row by row; the fourth row and column belong to the radius.
  std::array<double, 10> a{};
  std::array<double, 4> b{};  ///< the linear part
  double c = 0;               ///< the constant part

  /// The quadric of one plane through `point` with the unit normal `normal`, times `weight`.
  [[nodiscard]] static SphericalQuadric of_plane(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                                                 double weight = 1) noexcept;
  /// weight |q - point|^2: what keeps the centre of a sphere near a point, whatever its radius.
  [[nodiscard]] static SphericalQuadric of_point(const Eigen::Vector3d& point, double weight = 1) noexcept;
  /// The integral of eps |q - x|^2 over a triangle: the regulariser. It adds up over a region, and leaves no minimum
  /// undetermined but the radius.
  [[nodiscard]] static SphericalQuadric of_triangle_spread(const std::array<Eigen::Vector3d, 3>& corners,
                                                           double eps) noexcept;

  /// The quadric of the union.
  SphericalQuadric& operator+=(const SphericalQuadric& other) noexcept {
    for (std::size_t k = 0; k < a.size(); ++k) a[k] += other.a[k];
    for (std::size_t k = 0; k < b.size(); ++k) b[k] += other.b[k];
    c += other.c;
    return *this;
  }
  /// The same planes moved by `offset`: translated(t)(q + t, r) = Q(q, r).
  [[nodiscard]] SphericalQuadric translated(const Eigen::Vector3d& offset) const noexcept;

  /// The error of a sphere.
  [[nodiscard]] double operator()(const Sphere& sphere) const noexcept;

  /// A as a matrix.
  [[nodiscard]] Eigen::Matrix4d matrix() const;
};

inline SphericalQuadric SphericalQuadric::translated(const Eigen::Vector3d& t) const noexcept {
  SphericalQuadric moved = *this;
  const double ax = a[0] * t.x() + a[1] * t.y() + a[2] * t.z();
  const double ay = a[1] * t.x() + a[4] * t.y() + a[5] * t.z();
  const double az = a[2] * t.x() + a[5] * t.y() + a[7] * t.z();
  moved.b[0] += ax;
  moved.b[1] += ay;
  moved.b[2] += az;
  moved.b[3] += a[3] * t.x() + a[6] * t.y() + a[8] * t.z();
  moved.c += t.x() * (b[0] + 0.5 * ax) + t.y() * (b[1] + 0.5 * ay) + t.z() * (b[2] + 0.5 * az);
  return moved;
}

/// The quadric of the union.
[[nodiscard]] inline SphericalQuadric operator+(SphericalQuadric left, const SphericalQuadric& right) noexcept {
  left += right;
  return left;
}

/// Where the minimum of a quadric is looked for: R^3 x [0, max_radius], or [from, to] x [0, max_radius] where the
/// quadric does not determine a centre.
struct SphereDomain {
  Eigen::Vector3d from = Eigen::Vector3d::Zero();  ///< of the edge that is collapsed
  Eigen::Vector3d to = Eigen::Vector3d::Zero();    ///< of the edge that is collapsed
  double max_radius = 0;                           ///< the bound of section 4.6.3
  /// A centre is determined if no direction's pivot is below this part of A's radius entry (twice the weighted area).
  /// Measured as det / (sum of principal 2x2 minors) of what is left of A once the radius is eliminated, which lies
  /// between a third of the smallest eigenvalue and the eigenvalue, in any frame.
  double pivot = 1e-4;
};

/// How a minimum was found (section 4.6.2).
enum class FitCase : unsigned char {
  Interior,    ///< the quadric's own minimum
  AtRadius,    ///< on r = 0 or r = max_radius, the centre free
  OnSegment,   ///< the centre on the segment [from, to]
  AtMidpoint,  ///< the centre half way, the best radius
};

/// The sphere that a region is approximated by.
struct SphereFit {
  Sphere sphere;                      ///< the minimiser
  double cost = 0;                    ///< the error there, not negative
  FitCase found = FitCase::Interior;  ///< how
};

/// The sphere of least error in the domain (section 4.6.2).
[[nodiscard]] SphereFit minimise(const SphericalQuadric& quadric, const SphereDomain& domain) noexcept;

}  // namespace armature::sdk
