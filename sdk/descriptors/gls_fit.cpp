#include "sdk/descriptors/gls_fit.h"

#include <cmath>

namespace armature::sdk {
namespace {

// Below so much of the second moments their spread is rounding.
constexpr double kNoSpread = 1e-12;
// Below so much of 1 the sphere's gradient is rounding: the normals cancel.
constexpr double kNoFit = 1e-12;

/// The weighted variance of the positions, times the weight.
double spread(const GlsSums& s) noexcept {
  return s.pp - s.p.squaredNorm() / s.weight;
}
bool spreads(const GlsSums& s) noexcept {
  return spread(s) > kNoSpread * s.pp;
}

}  // namespace

GlsSums& GlsSums::operator+=(const GlsSums& other) noexcept {
  weight += other.weight;
  p += other.p;
  n += other.n;
  pn += other.pn;
  pp += other.pp;
  return *this;
}

GlsSums GlsSums::about(const Eigen::Vector3d& by) const noexcept {
  return {.weight = weight,
          .p = p - weight * by,
          .n = n,
          .pn = pn - by.dot(n),
          .pp = pp - 2 * by.dot(p) + weight * by.squaredNorm()};
}

AlgebraicSphere fit_sphere(const GlsSums& s) noexcept {
  AlgebraicSphere u;
  if (!(s.weight > 0)) return u;
  const Eigen::Vector3d mean = s.p / s.weight;
  if (spreads(s)) u.q = 0.5 * (s.pn - mean.dot(s.n)) / spread(s);
  u.l = s.n / s.weight - 2 * u.q * mean;
  u.c = -u.l.dot(mean) - u.q * s.pp / s.weight;
  return u;
}

AlgebraicSphere fit_sphere_rate(const GlsSums& s, const GlsSums& ds) noexcept {
  AlgebraicSphere du;
  if (!(s.weight > 0)) return du;
  const AlgebraicSphere u = fit_sphere(s);
  const Eigen::Vector3d mean = s.p / s.weight;
  const Eigen::Vector3d dmean = (ds.p - mean * ds.weight) / s.weight;
  if (spreads(s)) {
    const double dtop = ds.pn - dmean.dot(s.n) - mean.dot(ds.n);
    const double dspread = ds.pp - dmean.dot(s.p) - mean.dot(ds.p);
    du.q = (0.5 * dtop - u.q * dspread) / spread(s);
  }
  du.l = (ds.n - s.n / s.weight * ds.weight) / s.weight - 2 * (du.q * mean + u.q * dmean);
  const double mean_pp = s.pp / s.weight;
  const double dmean_pp = (ds.pp - mean_pp * ds.weight) / s.weight;
  du.c = -du.l.dot(mean) - u.l.dot(dmean) - du.q * mean_pp - u.q * dmean_pp;
  return du;
}

Gls gls_of(const AlgebraicSphere& u) noexcept {
  const double norm2 = u.norm2();
  const double length = u.l.norm();
  if (!(norm2 > kNoFit) || !(length > 0)) return {};
  const double norm = std::sqrt(norm2);
  return {.tau = u.c / norm, .kappa = 2 * u.q / norm, .phi = norm2, .eta = u.l / length};
}

double gls_dissimilarity(const Gls& a, const Gls& b, double scale) noexcept {
  const double tau = (a.tau - b.tau) / scale;
  const double kappa = (a.kappa - b.kappa) * scale;
  const double phi = a.phi - b.phi;
  return tau * tau + kappa * kappa + phi * phi;
}

}  // namespace armature::sdk
