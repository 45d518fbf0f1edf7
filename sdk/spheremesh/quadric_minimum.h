#pragma once

#include <algorithm>
#include <cmath>

#include <armature/sdk/spheremesh/spherical_quadric.h>

namespace armature::sdk {

/// The minimiser over lambda in [0, 1] and r in [0, bound] of the convex 1/2 (A00 l^2 + 2 A01 l r + A11 r^2) - b0 l -
/// b1 r; A00 and A11 are positive.
struct SegmentQuadric {
  double a00, a01, a11, b0, b1;

  struct Minimum {
    double lambda, radius;
  };

  [[nodiscard]] double value(Minimum at) const noexcept {
    return 0.5 * (a00 * at.lambda * at.lambda + 2 * a01 * at.lambda * at.radius + a11 * at.radius * at.radius) -
           b0 * at.lambda - b1 * at.radius;
  }
  [[nodiscard]] double best_radius(double lambda, double bound) const noexcept {
    return std::clamp((b1 - a01 * lambda) / a11, 0.0, bound);
  }
  [[nodiscard]] double best_lambda(double radius) const noexcept {
    return std::clamp((b0 - a01 * radius) / a00, 0.0, 1.0);
  }
  [[nodiscard]] Minimum minimum(double bound) const noexcept {
    const double det = a00 * a11 - a01 * a01;
    const Minimum inside{(a11 * b0 - a01 * b1) / det, (a00 * b1 - a01 * b0) / det};
    if (inside.lambda >= 0 && inside.lambda <= 1 && inside.radius >= 0 && inside.radius <= bound) return inside;
    const Minimum sides[] = {
        {0, best_radius(0, bound)}, {1, best_radius(1, bound)}, {best_lambda(0), 0}, {best_lambda(bound), bound}};
    return *std::min_element(std::begin(sides), std::end(sides),
                             [&](Minimum x, Minimum y) { return value(x) < value(y); });
  }
};

/// The body of `minimise`, for callers that know the radius bound only at a price: `bound()` is called once at most,
/// and only if a positive radius is in question.
template <class Bound>
[[nodiscard]] inline SphereFit minimum_of(const SphericalQuadric& quadric, const Eigen::Vector3d& from,
                                          const Eigen::Vector3d& to, double pivot, Bound&& bound) noexcept {
  const auto& A = quadric.a;
  const double xx = A[0], xy = A[1], xz = A[2], xr = A[3], yy = A[4], yz = A[5], yr = A[6], zz = A[7], zr = A[8];
  const double rr = A[9];
  const double bx = quadric.b[0], by = quadric.b[1], bz = quadric.b[2], br = quadric.b[3];
  const Eigen::Vector3d middle = 0.5 * (from + to);
  const auto fit = [&](const Eigen::Vector3d& centre, double radius, double cost, FitCase found) {
    return SphereFit{{centre, radius}, std::max(cost, 0.0), found};
  };
  if (!(rr > 0)) return fit(middle, 0, quadric({middle, 0}), FitCase::AtMidpoint);

  // The radius eliminated: S q = g, and r = (b_r - a.q) / A_rr with a the mixed entries.
  const double inv = 1 / rr;
  const double sxx = xx - xr * xr * inv, sxy = xy - xr * yr * inv, sxz = xz - xr * zr * inv;
  const double syy = yy - yr * yr * inv, syz = yz - yr * zr * inv, szz = zz - zr * zr * inv;
  const double cxx = syy * szz - syz * syz, cxy = sxz * syz - sxy * szz, cxz = sxy * syz - sxz * syy;
  const double cyy = sxx * szz - sxz * sxz, cyz = sxy * sxz - sxx * syz, czz = sxx * syy - sxy * sxy;
  const double det = sxx * cxx + sxy * cxy + sxz * cxz;
  const double minors = cxx + cyy + czz;
  if (minors > 0 && det > pivot * rr * minors) {
    const double gx = bx - xr * br * inv, gy = by - yr * br * inv, gz = bz - zr * br * inv;
    const double inv_det = 1 / det;
    Eigen::Vector3d q((cxx * gx + cxy * gy + cxz * gz) * inv_det, (cxy * gx + cyy * gy + cyz * gz) * inv_det,
                      (cxz * gx + cyz * gy + czz * gz) * inv_det);
    const double r = (br - xr * q.x() - yr * q.y() - zr * q.z()) * inv;
    const double cost = quadric.c - 0.5 * (bx * q.x() + by * q.y() + bz * q.z() + br * r);
    double at = 0;
    if (r >= 0) {
      at = bound();
      if (r <= at) return fit(q, r, cost, FitCase::Interior);
    }
    // On r = at the 3x3 system A_qq q = b_q - r a; from the free minimum it is one step along A_qq^-1 a, with A_qq =
    // S + aa' / A_rr inverted by Sherman and Morrison.
    const double hx = (cxx * xr + cxy * yr + cxz * zr) * inv_det, hy = (cxy * xr + cyy * yr + cyz * zr) * inv_det,
                 hz = (cxz * xr + cyz * yr + czz * zr) * inv_det;
    const double stiffness = rr / (rr + xr * hx + yr * hy + zr * hz);
    const double step = r - at;
    q += (step * stiffness) * Eigen::Vector3d(hx, hy, hz);
    return fit(q, at, cost + 0.5 * step * step * rr * stiffness, FitCase::AtRadius);
  }

  const auto times = [&](const Eigen::Vector3d& v) {
    return Eigen::Vector3d(xx * v.x() + xy * v.y() + xz * v.z(), xy * v.x() + yy * v.y() + yz * v.z(),
                           xz * v.x() + yz * v.y() + zz * v.z());
  };
  const Eigen::Vector3d a(xr, yr, zr);
  const Eigen::Vector3d w = to - from;
  const Eigen::Vector3d aw = times(w);
  const SegmentQuadric line{w.dot(aw), a.dot(w), rr, bx * w.x() + by * w.y() + bz * w.z() - from.dot(aw),
                            br - a.dot(from)};
  if (line.a00 - line.a01 * line.a01 * inv > pivot * rr * w.squaredNorm()) {
    const auto at = line.minimum(bound());
    const Sphere sphere{from + at.lambda * w, at.radius};
    return fit(sphere.centre, sphere.radius, quadric(sphere), FitCase::OnSegment);
  }
  const double free = (br - a.dot(middle)) * inv;
  const double radius = free > 0 ? std::min(free, bound()) : 0;
  return fit(middle, radius, quadric({middle, radius}), FitCase::AtMidpoint);
}

}  // namespace armature::sdk
