#include <Eigen/Geometry>
#include <armature/sdk/spheremesh/spherical_quadric.h>

#include "sdk/spheremesh/quadric_minimum.h"

namespace armature::sdk {

SphericalQuadric SphericalQuadric::of_plane(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                                            double weight) noexcept {
  const Eigen::Vector4d n(normal.x(), normal.y(), normal.z(), 1);
  const double offset = normal.dot(point);
  SphericalQuadric quadric;
  std::size_t k = 0;
  for (int row = 0; row < 4; ++row) {
    for (int column = row; column < 4; ++column) quadric.a[k++] = 2 * weight * n[row] * n[column];
    quadric.b[static_cast<std::size_t>(row)] = 2 * weight * offset * n[row];
  }
  quadric.c = weight * offset * offset;
  return quadric;
}

SphericalQuadric SphericalQuadric::of_point(const Eigen::Vector3d& point, double weight) noexcept {
  SphericalQuadric quadric;
  quadric.a[0] = quadric.a[4] = quadric.a[7] = 2 * weight;
  for (int k = 0; k < 3; ++k) quadric.b[static_cast<std::size_t>(k)] = 2 * weight * point[k];
  quadric.c = weight * point.squaredNorm();
  return quadric;
}

SphericalQuadric SphericalQuadric::of_triangle_spread(const std::array<Eigen::Vector3d, 3>& corners,
                                                      double eps) noexcept {
  const auto& [p, q, r] = corners;
  const double area = 0.5 * (q - p).cross(r - p).norm();
  const Eigen::Vector3d sum = p + q + r;
  SphericalQuadric quadric = of_point(sum / 3, eps * area);
  // The second moment of a triangle about the origin.
  quadric.c = eps * area / 12 * (p.squaredNorm() + q.squaredNorm() + r.squaredNorm() + sum.squaredNorm());
  return quadric;
}

double SphericalQuadric::operator()(const Sphere& sphere) const noexcept {
  const double x = sphere.centre.x(), y = sphere.centre.y(), z = sphere.centre.z(), r = sphere.radius;
  return 0.5 * (a[0] * x * x + a[4] * y * y + a[7] * z * z + a[9] * r * r) + x * (a[1] * y + a[2] * z + a[3] * r) +
         y * (a[5] * z + a[6] * r) + a[8] * z * r - (b[0] * x + b[1] * y + b[2] * z + b[3] * r) + c;
}

Eigen::Matrix4d SphericalQuadric::matrix() const {
  Eigen::Matrix4d m;
  m << a[0], a[1], a[2], a[3],  //
      a[1], a[4], a[5], a[6],   //
      a[2], a[5], a[7], a[8],   //
      a[3], a[6], a[8], a[9];
  return m;
}

SphereFit minimise(const SphericalQuadric& quadric, const SphereDomain& domain) noexcept {
  return minimum_of(quadric, domain.from, domain.to, domain.pivot, [&] { return domain.max_radius; });
}

}  // namespace armature::sdk
