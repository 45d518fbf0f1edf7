#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include <Eigen/Core>

#include "sdk/spheremesh/gauges.h"

namespace armature::sdk {

/// The distances of gauges.h for several points at once, in the shape that compilers turn into vector instructions: no
/// branches, the same operations in the same order for each.
constexpr std::size_t kLanes = 8;
using Lanes = std::array<double, kLanes>;

/// Points side by side; where there are fewer the last one is repeated.
struct PointLanes {
  alignas(64) Lanes x;
  alignas(64) Lanes y;
  alignas(64) Lanes z;
  double reach = 0;  ///< the farthest of them from `centre`

  PointLanes(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& centre) noexcept {
    for (std::size_t k = 0; k < kLanes; ++k) {
      const Eigen::Vector3d& p = points[std::min(k, points.size() - 1)];
      x[k] = p[0], y[k] = p[1], z[k] = p[2];
      reach = std::max(reach, (p - centre).squaredNorm());
    }
    reach = std::sqrt(reach);
  }
};

/// Signed distances, and how far along from a towards b the touched spheres lie.
inline void distances(const EdgeGauge& edge, const PointLanes& p, Lanes& distance, Lanes& along) noexcept {
  // Values of its own: nothing that is written can be one of them.
  const double ax = edge.a[0], ay = edge.a[1], az = edge.a[2];
  const double ux = edge.u[0], uy = edge.u[1], uz = edge.u[2];
  const double length = edge.length, lean = edge.lean, cosine = edge.cosine, g = edge.g;
  const double radius_a = edge.radius_a, radius_b = edge.radius_b;
  Lanes d, t;
  for (std::size_t k = 0; k < kLanes; ++k) {
    const double vx = p.x[k] - ax;
    const double vy = p.y[k] - ay;
    const double vz = p.z[k] - az;
    const double x = vx * ux + vy * uy + vz * uz;
    const double wx = vx - x * ux;
    const double wy = vy - x * uy;
    const double wz = vz - x * uz;
    const double away2 = wx * wx + wy * wy + wz * wz;
    const double away = std::sqrt(away2);
    const double free = x + lean * away;
    double there = free < length ? free : length;
    there = there > 0 ? there : 0;
    const double past = x - there;
    const double ball = std::sqrt(past * past + away2) - (free > 0 ? radius_b : radius_a);
    const double cone = away * cosine - g * x - radius_a;
    // Between the ends both are the same; elsewhere the ball is what is touched, and reaches no farther than the cone.
    d[k] = there == free ? cone : ball;
    t[k] = there;
  }
  distance = d;
  along = t;
}

/// Signed distances, infinite where the touched sphere does not lie within the triangle, and the weights of b and c.
inline void distances(const FacetGauge& facet, const PointLanes& p, Lanes& distance, Lanes& b, Lanes& c) noexcept {
  constexpr double nowhere = std::numeric_limits<double>::infinity();
  const FacetGauge f = facet;
  Lanes d, wb, wc;
  for (std::size_t k = 0; k < kLanes; ++k) {
    const double vx = p.x[k] - f.a[0];
    const double vy = p.y[k] - f.a[1];
    const double vz = p.z[k] - f.a[2];
    const double height = std::abs(vx * f.n[0] + vy * f.n[1] + vz * f.n[2]);
    wb[k] = vx * f.to_b[0] + vy * f.to_b[1] + vz * f.to_b[2] + height * f.lean_b;
    wc[k] = vx * f.to_c[0] + vy * f.to_c[1] + vz * f.to_c[2] + height * f.lean_c;
    const double above = height * f.cosine - (vx * f.g[0] + vy * f.g[1] + vz * f.g[2]) - f.radius_a;
    const double least = std::min(std::min(wb[k], wc[k]), 1 - wb[k] - wc[k]);
    d[k] = least >= 0 ? above : nowhere;
  }
  distance = d;
  b = wb;
  c = wc;
}

}  // namespace armature::sdk
