#include <algorithm>
#include <cmath>
#include <limits>

#include <armature/sdk/spheremesh/primitives.h>

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

/// The crossings found so far. All candidates lie on or in a convex body and its true crossings are among them, so the
/// extremes are those.
struct Crossings {
  RayHit entry{std::numeric_limits<double>::infinity(), 0};
  RayHit exit{-std::numeric_limits<double>::infinity(), 0};

  void add(double t, double blend) noexcept {
    if (t < entry.t) entry = {t, blend};
    if (t > exit.t) exit = {t, blend};
  }
  [[nodiscard]] std::optional<RayHit> first_ahead() const noexcept {
    if (entry.t > exit.t) return std::nullopt;
    if (entry.t > 0) return entry;
    if (exit.t > 0) return exit;
    return std::nullopt;
  }
};

void add_sphere(const Vector3d& to_centre, double inside, const Vector3d& direction, double length2, double blend,
                Crossings& crossings) noexcept {
  const double half_b = direction.dot(to_centre);
  const double discriminant = half_b * half_b - length2 * inside;
  if (discriminant < 0) return;
  const double root = std::sqrt(discriminant);
  crossings.add((half_b - root) / length2, blend);
  crossings.add((half_b + root) / length2, blend);
}

}  // namespace

double signed_distance(const Sphere& sphere, const Vector3d& point) noexcept {
  return (point - sphere.centre).norm() - sphere.radius;
}

double signed_distance(const SphereEdge& edge, const Vector3d& point) noexcept {
  const Vector3d axis = edge.b.centre - edge.a.centre;
  const double length = axis.norm();
  const double growth = edge.b.radius - edge.a.radius;
  if (length <= std::abs(growth)) return signed_distance(growth > 0 ? edge.b : edge.a, point);

  // |p - c| - r is convex along the edge; its minimum lies off the projection because the radius grows.
  const Vector3d u = axis / length;
  const double g = growth / length;
  const double along = (point - edge.a.centre).dot(u);
  const double away = (point - edge.a.centre - along * u).norm();
  const double blend = std::clamp((along + g * away / std::sqrt(1 - g * g)) / length, 0.0, 1.0);
  return signed_distance(interpolated(edge, blend), point);
}

std::optional<RayHit> intersect(const Sphere& sphere, const Ray& ray) noexcept {
  Crossings crossings;
  const Vector3d to_centre = sphere.centre - ray.origin;
  add_sphere(to_centre, to_centre.squaredNorm() - sphere.radius * sphere.radius, ray.direction,
             ray.direction.squaredNorm(), 0, crossings);
  return crossings.first_ahead();
}

std::optional<RayHit> intersect(const SphereEdge& edge, const Ray& ray) noexcept {
  return EdgeCaster(edge, ray.origin).cast(ray.direction);
}

Vector3d surface_normal(const SphereEdge& edge, const Ray& ray, const RayHit& hit) noexcept {
  return (ray.origin + hit.t * ray.direction - interpolated(edge, hit.blend).centre).normalized();
}

EdgeCaster::EdgeCaster(const SphereEdge& edge, const Vector3d& origin) noexcept
    : to_a_(edge.a.centre - origin), to_b_(edge.b.centre - origin), axis_(edge.b.centre - edge.a.centre) {
  const double ra = edge.a.radius;
  const double rb = edge.b.radius;
  const double length2 = axis_.squaredNorm();
  const double shrink = ra - rb;
  inside_a_ = to_a_.squaredNorm() - ra * ra;
  inside_b_ = to_b_.squaredNorm() - rb * rb;
  side_ = length2 - shrink * shrink;
  has_a_ = side_ > 0 || ra >= rb;
  has_b_ = side_ > 0 || rb > ra;

  // The cone through both contact circles, with m = -axis.to_a and q = the point relative to a:
  // side |q|^2 - (axis.q)^2 + 2 ra shrink axis.q - length^2 ra^2 = 0.
  const double m = -axis_.dot(to_a_);
  taper_ = shrink * ra - m;
  cone_0_ = side_ * to_a_.squaredNorm() - m * m + 2 * ra * shrink * m - length2 * ra * ra;
  along_0_ = m - ra * shrink;
}

std::optional<RayHit> EdgeCaster::cast(const Vector3d& direction) const noexcept {
  Crossings crossings;
  const double length2 = direction.squaredNorm();
  if (side_ > 0) {
    const double along_t = axis_.dot(direction);
    const double k2 = side_ * length2 - along_t * along_t;
    const double k1 = -side_ * direction.dot(to_a_) + taper_ * along_t;
    const auto add = [&](double t) {
      const double along = along_0_ + t * along_t;
      if (along >= 0 && along <= side_) crossings.add(t, along / side_);
    };
    const double discriminant = k1 * k1 - k2 * cone_0_;
    // The hull lies within the infinite cone: a ray that crosses towards it and misses the cone misses the hull.
    if (discriminant < 0 && k2 > 0) return std::nullopt;
    if (discriminant >= 0 && k2 != 0) {
      const double root = std::sqrt(discriminant);
      const double near = (-k1 - root) / k2;
      const double near_along = along_0_ + near * along_t;
      // There is one way into a convex body: no need to look for another.
      if (k2 > 0 && near > 0 && near_along >= 0 && near_along <= side_) return RayHit{near, near_along / side_};
      add(near);
      add((-k1 + root) / k2);
    } else if (k2 == 0 && k1 != 0) {
      add(-cone_0_ / (2 * k1));
    }
  }
  if (has_a_) add_sphere(to_a_, inside_a_, direction, length2, 0, crossings);
  if (has_b_) add_sphere(to_b_, inside_b_, direction, length2, 1, crossings);
  return crossings.first_ahead();
}

}  // namespace armature::sdk
