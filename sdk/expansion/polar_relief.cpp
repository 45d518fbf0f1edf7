#include "sdk/expansion/polar_relief.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>

namespace armature::sdk {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// The sector of one relief that a sector of the other comes to lie on.
std::size_t sector_onto(std::size_t sector, std::size_t shift, bool mirrored) {
  constexpr std::size_t n = PolarRelief::kSectors;
  return mirrored ? (shift + n - sector) % n : (shift + sector) % n;
}

}  // namespace

double difference(const PolarRelief& reference, const PolarRelief& target, std::size_t shift, bool mirrored) {
  double sum = 0;
  double area = 0;
  for (std::size_t ring = 0; ring < PolarRelief::kRings; ++ring)
    for (std::size_t k = 0; k < PolarRelief::kSectors; ++k) {
      const std::size_t onto = sector_onto(k, shift, mirrored);
      const double both = std::min(reference.area[ring][k], target.area[ring][onto]);
      sum += both * std::pow(reference.height[ring][k] - target.height[ring][onto], 2);
      area += both;
    }
  return area > 0 ? sum / area : 0;
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
    if ((s.point - centre).norm() <= radius) normal += s.area * s.normal;
  if (!(normal.norm() > 0)) return relief;
  const Vector3d n = normal.normalized();
  const Vector3d u = n.unitOrthogonal();
  relief.frame << u, n.cross(u), n;
  double mean = 0;
  double all = 0;
  for (const SurfaceSample& s : samples) {
    const Vector3d x = relief.frame.transpose() * (s.point - centre) / radius;
    const double distance = x.head<2>().norm();
    if (distance >= 1) continue;
    const double turn = std::atan2(x.y(), x.x()) / (2 * std::numbers::pi);
    const auto sector = static_cast<std::size_t>((turn < 0 ? turn + 1 : turn) * PolarRelief::kSectors);
    const auto ring = static_cast<std::size_t>(distance * PolarRelief::kRings);
    const double area = s.area / (radius * radius);
    relief.height[ring][sector % PolarRelief::kSectors] += area * x.z();
    relief.area[ring][sector % PolarRelief::kSectors] += area;
    mean += area * x.z();
    all += area;
  }
  for (std::size_t ring = 0; ring < PolarRelief::kRings; ++ring)
    for (std::size_t k = 0; k < PolarRelief::kSectors; ++k) {
      const double area = relief.area[ring][k];
      relief.height[ring][k] = area > 0 ? relief.height[ring][k] / area - mean / all : 0;
    }
  return relief;
}

}  // namespace armature::sdk
