#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <armature/sdk/spheremesh/sphere_triangle.h>

namespace armature::sdk {

/// An edge prepared for many distances. |p - c| - r is convex along it; its minimum lies off the projection because the
/// radius grows, by the gradient g.
struct EdgeGauge {
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  Eigen::Vector3d u = Eigen::Vector3d::UnitX();  ///< from a to b
  double length = 0;                             ///< 0 where one sphere holds the other: the larger one is a, or b
  double radius_a = 0, radius_b = 0;
  double g = 0;       ///< growth of the radius
  double cosine = 1;  ///< sqrt(1 - g^2)
  double lean = 0;    ///< g / cosine
  bool b_is_all = false;

  EdgeGauge() = default;
  explicit EdgeGauge(const SphereEdge& edge) noexcept {
    const Eigen::Vector3d axis = edge.b.centre - edge.a.centre;
    const double growth = edge.b.radius - edge.a.radius;
    const double distance = axis.norm();
    a = edge.a.centre;
    radius_a = edge.a.radius;
    radius_b = edge.b.radius;
    if (!(distance > std::abs(growth) * (1 + 1e-12))) {
      b_is_all = growth > 0;
      if (b_is_all) a = edge.b.centre, radius_a = edge.b.radius;
      radius_b = radius_a;
      return;
    }
    length = distance;
    u = axis / distance;
    g = growth / distance;
    cosine = std::sqrt((1 - g) * (1 + g));
    lean = g / cosine;
  }

  /// Signed distance, and how far along from a towards b (0 to length) the touched sphere lies.
  [[nodiscard]] double distance(const Eigen::Vector3d& point, double& along) const noexcept {
    const Eigen::Vector3d v = point - a;
    const double x = v.dot(u);
    const double away = (v - x * u).norm();
    along = x + lean * away;
    if (along <= 0 || length == 0) {
      along = 0;
      return v.norm() - radius_a;
    }
    if (along >= length) {
      along = length;
      return std::sqrt((x - length) * (x - length) + away * away) - radius_b;
    }
    return away * cosine - g * x - radius_a;
  }
  /// The weight of b.
  [[nodiscard]] double blend(double along) const noexcept { return length > 0 ? along / length : b_is_all ? 1 : 0; }
  [[nodiscard]] Eigen::Vector3d centre(double along) const noexcept { return a + along * u; }
  /// Outward at the touched sphere, as seen from the point.
  [[nodiscard]] Eigen::Vector3d normal(const Eigen::Vector3d& point, double along) const noexcept;
};

/// The inside of a triangle prepared for many distances: what its edges do not cover.
struct FacetGauge {
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  Eigen::Vector3d n = Eigen::Vector3d::UnitZ();  ///< of the plane of the centres
  Eigen::Vector3d g = Eigen::Vector3d::Zero();   ///< gradient of the radius in that plane
  Eigen::Vector3d to_b = Eigen::Vector3d::Zero(), to_c = Eigen::Vector3d::Zero();  ///< dual: weights of b and c
  double lean_b = 0, lean_c = 0;  ///< how the weights move with the height above the plane
  double rate_b = 0, rate_c = 0;  ///< the most that the weights move to a length
  double radius_a = 0;
  double growth_b = 0, growth_c = 0;  ///< of the radius towards b and c
  double cosine = 1;                  ///< sqrt(1 - |g|^2)
  bool exists = false;

  FacetGauge() = default;
  explicit FacetGauge(const SphereTriangle& t) noexcept {
    constexpr double kSliver = 1e-18;  // squared sine below which the centres are taken to lie on a line
    const Eigen::Vector3d ab = t.b.centre - t.a.centre;
    const Eigen::Vector3d ac = t.c.centre - t.a.centre;
    const Eigen::Vector3d cross = ab.cross(ac);
    const double area2 = cross.squaredNorm();
    const double longest2 = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
    if (!(area2 > kSliver * longest2 * longest2)) return;
    a = t.a.centre;
    radius_a = t.a.radius;
    n = cross / std::sqrt(area2);
    to_b = ac.cross(cross) / area2;
    to_c = cross.cross(ab) / area2;
    growth_b = t.b.radius - t.a.radius;
    growth_c = t.c.radius - t.a.radius;
    g = growth_b * to_b + growth_c * to_c;
    const double g2 = g.squaredNorm();
    if (!(g2 < 1 - 1e-12)) return;
    exists = true;
    cosine = std::sqrt(1 - g2);
    lean_b = to_b.dot(g) / cosine;
    lean_c = to_c.dot(g) / cosine;
    rate_b = to_b.norm() + std::abs(lean_b);
    rate_c = to_c.norm() + std::abs(lean_c);
  }

  /// Signed distance if the touched sphere lies within the triangle, weights of b and c; otherwise false.
  [[nodiscard]] bool distance(const Eigen::Vector3d& point, double& d, double& b, double& c) const noexcept {
    const Eigen::Vector3d v = point - a;
    const double height = std::abs(v.dot(n));
    b = v.dot(to_b) + height * lean_b;
    c = v.dot(to_c) + height * lean_c;
    d = height * cosine - g.dot(v) - radius_a;
    return exists && b >= 0 && c >= 0 && b + c <= 1;
  }
  /// Whether the point's foot on a facet's plane, `distance` away along `normal`, lies on the facet.
  [[nodiscard]] bool holds_foot(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                                double distance) const noexcept {
    // The foot is c + r normal; in the plane that is the linear map c -> c - r g, which we undo.
    const Eigen::Vector3d v = point + distance * normal - a + radius_a * g;
    const double wb = v.dot(to_b);
    const double wc = v.dot(to_c);
    const double gb = to_b.dot(g);
    const double gc = to_c.dot(g);
    const double determinant = 1 - gb * growth_b - gc * growth_c;
    const double b = ((1 - gc * growth_c) * wb + gb * growth_c * wc) / determinant;
    const double c = (gc * growth_b * wb + (1 - gb * growth_b) * wc) / determinant;
    return b >= 0 && c >= 0 && b + c <= 1;
  }
  /// The facet's normal on the side of n (sign = 1) or the other (-1).
  [[nodiscard]] Eigen::Vector3d normal(double sign) const noexcept { return sign * cosine * n - g; }
};

/// Any unit vector at right angles to one.
[[nodiscard]] inline Eigen::Vector3d any_normal_to(const Eigen::Vector3d& u) noexcept {
  Eigen::Index least = 0;
  u.cwiseAbs().minCoeff(&least);
  return u.cross(Eigen::Vector3d::Unit(least)).normalized();
}

inline Eigen::Vector3d EdgeGauge::normal(const Eigen::Vector3d& point, double along) const noexcept {
  const Eigen::Vector3d d = point - centre(along);
  const double size = d.norm();
  // At the centre of the touched sphere every direction that touches the hull there is as near as any other.
  if (size > 1e-14 * (length + radius_a + radius_b)) return d / size;
  if (length == 0) return Eigen::Vector3d::UnitZ();
  return cosine * any_normal_to(u) - g * u;
}

}  // namespace armature::sdk
