#include "sdk/expansion/polar_relief.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>

namespace armature::sdk {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

/// The sector of a direction, in one of eight by its slope, without any arc tangent.
Eigen::Index sector_of(double x, double y) {
  constexpr Eigen::Index kEighth = PolarRelief::kSectors / 8;
  constexpr std::array<double, kEighth - 1> kSlopes = {0.13165249758739585, 0.2679491924311227, 0.41421356237309503,
                                                       0.5773502691896257, 0.7673269879789604};
  const double along = std::max(std::abs(x), std::abs(y));
  const double across = std::min(std::abs(x), std::abs(y));
  Eigen::Index sector = 0;
  for (const double slope : kSlopes) sector += across >= slope * along ? 1 : 0;
  if (std::abs(y) > std::abs(x)) sector = 2 * kEighth - 1 - sector;
  if (x < 0) sector = 4 * kEighth - 1 - sector;
  return y < 0 ? 8 * kEighth - 1 - sector : sector;
}

}  // namespace

std::array<float, PolarRelief::kSectors> differences(const PolarRelief& reference, const PolarRelief& target,
                                                     bool mirrored) {
  constexpr Eigen::Index n = PolarRelief::kSectors;
  PolarRelief::Cells height = reference.height;
  PolarRelief::Cells area = reference.area;
  if (mirrored) {  // sector k comes to lie on -k
    height.bottomRows<n - 1>() = reference.height.bottomRows<n - 1>().colwise().reverse();
    area.bottomRows<n - 1>() = reference.area.bottomRows<n - 1>().colwise().reverse();
  }
  using Twice = Eigen::Array<float, 2 * n, PolarRelief::kRings>;  // so that turns are whole runs
  const Twice onto_height = target.height.replicate<2, 1>();
  const Twice onto_area = target.area.replicate<2, 1>();
  std::array<float, n> result{};
  for (Eigen::Index shift = 0; shift < n; ++shift) {
    const PolarRelief::Cells both = area.min(onto_area.middleRows<n>(shift));
    const float all = both.sum();
    const float squares = (both * (height - onto_height.middleRows<n>(shift)).square()).sum();
    result[static_cast<std::size_t>(shift)] = all > 0 ? squares / all : 0;
  }
  return result;
}

Matrix3d turn_by(const PolarRelief& reference, const PolarRelief& target, std::size_t shift, bool mirrored) {
  const double angle = 2 * std::numbers::pi * static_cast<double>(shift) / PolarRelief::kSectors;
  // A shift s takes sector k, whose middle is at k + 1/2, to s + k; mirrored, to s - k.
  const double a = mirrored ? angle + 2 * std::numbers::pi / PolarRelief::kSectors : angle;
  Matrix3d about_normal;
  about_normal << std::cos(a), mirrored ? std::sin(a) : -std::sin(a), 0,  //
      std::sin(a), mirrored ? -std::cos(a) : std::cos(a), 0,              //
      0, 0, 1;
  return target.frame * about_normal * reference.frame.transpose();
}

PolarRelief relief_of(std::span<const SurfaceSample> samples, const Vector3d& centre, double radius) {
  PolarRelief relief;
  Vector3d normal = Vector3d::Zero();
  for (const SurfaceSample& s : samples)
    if ((s.point - centre).squaredNorm() <= radius * radius) normal += s.area * s.normal;
  if (!(normal.norm() > 0)) return relief;
  const Vector3d n = normal.normalized();
  const Vector3d u = n.unitOrthogonal();
  relief.frame << u, n.cross(u), n;
  const Matrix3d into_frame = relief.frame.transpose() / radius;
  double mean = 0;
  double all = 0;
  for (const SurfaceSample& s : samples) {
    const Vector3d x = into_frame * (s.point - centre);
    const double distance2 = x.head<2>().squaredNorm();
    if (!(distance2 < 1)) continue;
    const auto ring = static_cast<Eigen::Index>(std::sqrt(distance2) * PolarRelief::kRings);
    const Eigen::Index sector = sector_of(x.x(), x.y());
    const double area = s.area / (radius * radius);
    relief.height(sector, ring) += static_cast<float>(area * x.z());
    relief.area(sector, ring) += static_cast<float>(area);
    mean += area * x.z();
    all += area;
  }
  relief.height = (relief.area > 0).select(relief.height / relief.area - static_cast<float>(mean / all), 0);
  return relief;
}

}  // namespace armature::sdk
