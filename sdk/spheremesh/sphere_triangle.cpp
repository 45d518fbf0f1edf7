#include <limits>

#include <armature/sdk/spheremesh/sphere_triangle.h>

#include "sdk/spheremesh/gauges.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

/// The sides of a triangle by their ends' corners.
constexpr std::array<std::array<Eigen::Index, 2>, 3> kSides{{{0, 1}, {1, 2}, {2, 0}}};

std::array<SphereEdge, 3> sides(const SphereTriangle& t) noexcept {
  return {SphereEdge{t.a, t.b}, SphereEdge{t.b, t.c}, SphereEdge{t.c, t.a}};
}

/// An outward normal where the touched sphere is centred on the point, so that the point tells no direction: of the
/// directions that touch an edge there and lean away from its third sphere, the one that clears all three best.
Vector3d normal_at_centre(const SphereTriangle& t, const FacetGauge& facet, const Vector3d& point,
                          double radius) noexcept {
  if (facet.exists) return facet.normal(1);
  const std::array<const Sphere*, 3> spheres{&t.a, &t.b, &t.c};
  Vector3d best = Vector3d::UnitZ();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const EdgeGauge edge({*spheres[k], *spheres[(k + 1) % 3]});
    const Vector3d to_third = spheres[(k + 2) % 3]->centre - edge.a;
    Vector3d away = to_third.dot(edge.u) * edge.u - to_third;
    away = away.squaredNorm() > 0 ? away.normalized() : any_normal_to(edge.u);
    const Vector3d normal = edge.cosine * away - edge.g * edge.u;
    double over = 0;
    for (const Sphere* s : spheres) over = std::max(over, normal.dot(s->centre - point) + s->radius - radius);
    if (over >= least) continue;
    least = over;
    best = normal;
  }
  return best;
}

/// Grows a passage by another part of the same convex shape.
void join(std::optional<Passage>& whole, const std::optional<Passage>& part) noexcept {
  if (!part) return;
  if (!whole) {
    whole = part;
    return;
  }
  if (part->entry.t < whole->entry.t) whole->entry = part->entry;
  if (part->exit.t > whole->exit.t) whole->exit = part->exit;
}

/// A stretch of a line that half spaces cut down.
struct Stretch {
  double entry = -std::numeric_limits<double>::infinity();
  double exit = std::numeric_limits<double>::infinity();

  /// Keeps where offset + t slope <= 0.
  void cut(double offset, double slope) noexcept {
    if (slope > 0)
      exit = std::min(exit, -offset / slope);
    else if (slope < 0)
      entry = std::max(entry, -offset / slope);
    else if (offset > 0)
      exit = -std::numeric_limits<double>::infinity();
  }
  [[nodiscard]] bool empty() const noexcept { return !(entry <= exit); }
};

/// The cone between the contact circles of an edge. In the coordinates x along the axis and y away from it the hull
/// there is cosine |y| <= radius_a + g x.
std::optional<Passage> cone_passage(const EdgeGauge& e, const Ray& ray) noexcept {
  const Vector3d v = ray.origin - e.a;
  const double x0 = v.dot(e.u);
  const double x1 = ray.direction.dot(e.u);
  const Vector3d y0 = v - x0 * e.u;
  const Vector3d y1 = ray.direction - x1 * e.u;
  // Between the circles: the touched sphere of a surface point lies at along = (x + g radius_a) / cosine^2.
  const double c2 = e.cosine * e.cosine;
  Stretch stretch;
  stretch.cut(-(x0 + e.g * e.radius_a), -x1);
  stretch.cut(x0 + e.g * e.radius_a - c2 * e.length, x1);
  if (stretch.empty()) return std::nullopt;

  // cosine^2 |y|^2 - (radius_a + g x)^2 <= 0, on the side where radius_a + g x >= 0 (which the stretch is on).
  const double h0 = e.radius_a + e.g * x0;
  const double h1 = e.g * x1;
  const double k2 = c2 * y1.squaredNorm() - h1 * h1;
  const double k1 = c2 * y0.dot(y1) - h0 * h1;
  const double k0 = c2 * y0.squaredNorm() - h0 * h0;
  const double discriminant = k1 * k1 - k2 * k0;
  const auto crossing = [&](double t) {
    const double along = (x0 + t * x1 + e.g * e.radius_a) / c2;
    const double blend = std::clamp(along / e.length, 0.0, 1.0);
    return Crossing{t, {1 - blend, blend, 0}};
  };
  if (k2 > 0) {
    if (discriminant < 0) return std::nullopt;
    const double root = std::sqrt(discriminant);
    // The root that does not cancel first, the other one from their product.
    const double q = k1 > 0 ? -(k1 + root) : root - k1;
    const double r1 = q / k2;
    const double r2 = q != 0 ? k0 / q : r1;
    stretch.entry = std::max(stretch.entry, std::min(r1, r2));
    stretch.exit = std::min(stretch.exit, std::max(r1, r2));
  } else {
    // Steeper than the cone: within it on one or both outer sides of the roots. The stretch is bounded and convex, so
    // only its ends and the roots inside it matter.
    const auto inside = [&](double t) { return k0 + t * (2 * k1 + t * k2) <= 0; };
    std::array<double, 2> roots{};
    int count = 0;
    if (k2 == 0) {
      if (k1 != 0) roots[static_cast<std::size_t>(count++)] = -k0 / (2 * k1);
    } else if (discriminant >= 0) {
      const double root = std::sqrt(discriminant);
      const double q = k1 > 0 ? -(k1 + root) : root - k1;
      roots = {q / k2, q != 0 ? k0 / q : q / k2};
      count = 2;
    }
    Stretch within{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    const auto add = [&](double t) {
      within.entry = std::min(within.entry, t);
      within.exit = std::max(within.exit, t);
    };
    if (!std::isfinite(stretch.entry) || !std::isfinite(stretch.exit)) return std::nullopt;
    if (inside(stretch.entry)) add(stretch.entry);
    if (inside(stretch.exit)) add(stretch.exit);
    for (int k = 0; k < count; ++k)
      if (const double t = roots[static_cast<std::size_t>(k)]; t >= stretch.entry && t <= stretch.exit) add(t);
    stretch = within;
  }
  if (stretch.empty()) return std::nullopt;
  return Passage{crossing(stretch.entry), crossing(stretch.exit)};
}

/// The prism between the two facets; its other three sides lie within the edges.
std::optional<Passage> prism_passage(const SphereTriangle& triangle, const FacetGauge& f, const Ray& ray) noexcept {
  const Vector3d v = ray.origin - f.a;
  const Vector3d& d = ray.direction;
  // A point of the facets is c - r g +- r cosine n: within the plane, the map c -> c - r g, which is linear.
  const double b0 = f.to_b.dot(v + f.radius_a * f.g), b1 = f.to_b.dot(d);
  const double c0 = f.to_c.dot(v + f.radius_a * f.g), c1 = f.to_c.dot(d);
  const double growth_b = triangle.b.radius - triangle.a.radius;
  const double growth_c = triangle.c.radius - triangle.a.radius;
  // (b0, c0) = M (b, c), M = 1 - (to_b.g, to_c.g)' (growth_b, growth_c).
  const double gb = f.to_b.dot(f.g);
  const double gc = f.to_c.dot(f.g);
  const double determinant = 1 - gb * growth_b - gc * growth_c;
  const auto weights = [&](double b, double c) {
    return std::array{((1 - gc * growth_c) * b + gb * growth_c * c) / determinant,
                      (gc * growth_b * b + (1 - gb * growth_b) * c) / determinant};
  };
  const auto w0 = weights(b0, c0);
  const auto w1 = weights(b1, c1);
  Stretch stretch;
  stretch.cut(-w0[0], -w1[0]);
  stretch.cut(-w0[1], -w1[1]);
  stretch.cut(w0[0] + w0[1] - 1, w1[0] + w1[1]);
  for (const double sign : {1.0, -1.0}) {
    const Vector3d normal = f.normal(sign);
    stretch.cut(normal.dot(v) - f.radius_a, normal.dot(d));
  }
  if (stretch.empty() || !std::isfinite(stretch.entry) || !std::isfinite(stretch.exit)) return std::nullopt;
  const auto crossing = [&](double t) {
    const double b = std::clamp(w0[0] + t * w1[0], 0.0, 1.0);
    const double c = std::clamp(w0[1] + t * w1[1], 0.0, 1 - b);
    return Crossing{t, {1 - b - c, b, c}};
  };
  return Passage{crossing(stretch.entry), crossing(stretch.exit)};
}

}  // namespace

Touch touch(const Sphere& sphere, const Vector3d& point) noexcept {
  const Vector3d d = point - sphere.centre;
  const double size = d.norm();
  return {size - sphere.radius, size > 0 ? Vector3d(d / size) : Vector3d::UnitZ(), Vector3d::UnitX()};
}

Touch touch(const SphereEdge& edge, const Vector3d& point) noexcept {
  const EdgeGauge gauge(edge);
  double along = 0;
  const double distance = gauge.distance(point, along);
  const double blend = gauge.blend(along);
  return {distance, gauge.normal(point, along), {1 - blend, blend, 0}};
}

Touch touch(const SphereTriangle& triangle, const Vector3d& point) noexcept {
  const FacetGauge facet(triangle);
  double distance = 0;
  double b = 0;
  double c = 0;
  if (facet.distance(point, distance, b, c))
    return {distance, facet.normal(facet.n.dot(point - facet.a) < 0 ? -1 : 1), {1 - b - c, b, c}};
  Touch best;
  best.distance = std::numeric_limits<double>::infinity();
  const auto edges = sides(triangle);
  for (std::size_t k = 0; k < 3; ++k) {
    const Touch on_edge = touch(edges[k], point);
    if (!(on_edge.distance < best.distance)) continue;
    best = on_edge;
    best.weights.setZero();
    best.weights[kSides[k][0]] = on_edge.weights[0];
    best.weights[kSides[k][1]] = on_edge.weights[1];
  }
  const Sphere touched = interpolated(triangle, best.weights);
  const double size = (point - touched.centre).norm() + touched.radius;
  if ((point - touched.centre).norm() <= 1e-14 * size)
    best.normal = normal_at_centre(triangle, facet, point, touched.radius);
  return best;
}

double signed_distance(const SphereTriangle& triangle, const Vector3d& point) noexcept {
  return touch(triangle, point).distance;
}

std::optional<Passage> passage(const Sphere& sphere, const Ray& ray) noexcept {
  const Vector3d v = ray.origin - sphere.centre;
  const double k2 = ray.direction.squaredNorm();
  const double k1 = v.dot(ray.direction);
  const Vector3d nearest = v - (k1 / k2) * ray.direction;
  const double rest = sphere.radius * sphere.radius - nearest.squaredNorm();
  if (!(rest >= 0)) return std::nullopt;
  const double middle = -k1 / k2;
  const double half = std::sqrt(rest / k2);
  return Passage{{middle - half, Vector3d::UnitX()}, {middle + half, Vector3d::UnitX()}};
}

std::optional<Passage> passage(const SphereEdge& edge, const Ray& ray) noexcept {
  const EdgeGauge gauge(edge);
  std::optional<Passage> whole;
  if (gauge.length > 0 || !gauge.b_is_all) join(whole, passage(edge.a, ray));
  if (gauge.length > 0 || gauge.b_is_all) {
    auto b = passage(edge.b, ray);
    if (b) b->entry.weights = b->exit.weights = Vector3d::UnitY();
    join(whole, b);
  }
  if (gauge.length > 0) join(whole, cone_passage(gauge, ray));
  return whole;
}

std::optional<Passage> passage(const SphereTriangle& triangle, const Ray& ray) noexcept {
  std::optional<Passage> whole;
  if (const FacetGauge facet(triangle); facet.exists) whole = prism_passage(triangle, facet, ray);
  const auto edges = sides(triangle);
  for (std::size_t k = 0; k < 3; ++k) {
    auto part = passage(edges[k], ray);
    if (!part) continue;
    for (Crossing* crossing : {&part->entry, &part->exit}) {
      const Vector3d on_edge = crossing->weights;
      crossing->weights.setZero();
      crossing->weights[kSides[k][0]] = on_edge[0];
      crossing->weights[kSides[k][1]] = on_edge[1];
    }
    join(whole, part);
  }
  return whole;
}

std::optional<Crossing> intersect(const SphereTriangle& triangle, const Ray& ray) noexcept {
  const auto through = passage(triangle, ray);
  if (!through) return std::nullopt;
  if (through->entry.t > 0) return through->entry;
  if (through->exit.t > 0) return through->exit;
  return std::nullopt;
}

std::optional<std::array<Vector3d, 2>> tangent_normals(const SphereTriangle& triangle) noexcept {
  const FacetGauge facet(triangle);
  if (!facet.exists) return std::nullopt;
  return std::array{facet.normal(1), facet.normal(-1)};
}

}  // namespace armature::sdk
