#pragma once

#include <algorithm>
#include <limits>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace armature::sdk {

/// A triangle with what its closest point needs.
struct Facet {
  using Vector3d = Eigen::Vector3d;

  /// Where on a facet: a + v ab + w ac.
  struct Place {
    double v = 0;
    double w = 0;
  };

  Vector3d a, ab, ac;
  double ab_ab, ab_ac, ac_ac;
  bool sliver;  // taken for its three sides

  Facet(const Vector3d& corner, const Vector3d& b, const Vector3d& c) noexcept
      : a(corner), ab(b - corner), ac(c - corner), ab_ab(ab.squaredNorm()), ab_ac(ab.dot(ac)), ac_ac(ac.squaredNorm()) {
    constexpr double kSliver = 1e-20;  // squared sine
    const double longest2 = std::max({ab_ab, ac_ac, (ac - ab).squaredNorm()});
    sliver = !(ab.cross(ac).squaredNorm() > kSliver * longest2 * longest2);
  }

  [[nodiscard]] Vector3d at(const Place& place) const noexcept { return a + place.v * ab + place.w * ac; }

  [[nodiscard]] double squared_distance(const Vector3d& point, const Place& place) const noexcept {
    return (point - a - place.v * ab - place.w * ac).squaredNorm();
  }
  [[nodiscard]] double squared_distance(const Vector3d& point) const noexcept {
    return squared_distance(point, closest(point));
  }

  /// The place closest to a point (Ericson, Real-Time Collision Detection, section 5.1.5).
  [[nodiscard]] Place closest(const Vector3d& point) const noexcept {
    const Vector3d ap = point - a;
    if (sliver) return closest_on_sides(ap);
    const double d1 = ab.dot(ap);
    const double d2 = ac.dot(ap);
    if (d1 <= 0 && d2 <= 0) return {};
    const double d3 = d1 - ab_ab;
    const double d4 = d2 - ab_ac;
    if (d3 >= 0 && d4 <= d3) return {1, 0};
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return {d1 / ab_ab, 0};
    const double d5 = d1 - ab_ac;
    const double d6 = d2 - ac_ac;
    if (d6 >= 0 && d5 <= d6) return {0, 1};
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return {0, d2 / ac_ac};
    const double va = d3 * d6 - d5 * d4;
    const double b_side = d4 - d3;
    const double c_side = d5 - d6;
    if (va <= 0 && b_side >= 0 && c_side >= 0) {
      const double w = b_side / (b_side + c_side);
      return {1 - w, w};
    }
    const double scale = 1 / (va + vb + vc);
    return {vb * scale, vc * scale};
  }

 private:
  [[nodiscard]] Place closest_on_sides(const Vector3d& ap) const noexcept {
    const auto along = [](const Vector3d& side, const Vector3d& from_start) {
      const double length2 = side.squaredNorm();
      return length2 > 0 ? std::clamp(side.dot(from_start) / length2, 0.0, 1.0) : 0.0;
    };
    const double on_ab = along(ab, ap);
    const double on_ac = along(ac, ap);
    const double on_bc = along(ac - ab, ap - ab);
    Place best;
    double least = std::numeric_limits<double>::infinity();
    for (const Place place : {Place{on_ab, 0}, Place{0, on_ac}, Place{1 - on_bc, on_bc}}) {
      const double distance2 = (ap - place.v * ab - place.w * ac).squaredNorm();
      if (distance2 < least) {
        least = distance2;
        best = place;
      }
    }
    return best;
  }
};

}  // namespace armature::sdk
