#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>
#include <armature/sdk/spheremesh/primitives.h>

namespace armature::sdk {

/// A triangle of a sphere-mesh: the convex hull of its three spheres, that is all spheres interpolated linearly between
/// them (thesis, section 4.3). With g the gradient of the radius in the plane of the centres and n that plane's normal,
/// its sides are two facets with normals +-sqrt(1 - |g|^2) n - g, each touching all three spheres, and three cones.
/// Where |g| >= 1, or the centres lie on a line, there are no facets: it is the union of its three edges.
struct SphereTriangle {
  Sphere a;  ///< of the first weight
  Sphere b;  ///< of the second weight
  Sphere c;  ///< of the third weight
};

/// The sphere with barycentric weights `weights` of the triangle.
[[nodiscard]] inline Sphere interpolated(const SphereTriangle& t, const Eigen::Vector3d& weights) noexcept {
  return {weights[0] * t.a.centre + weights[1] * t.b.centre + weights[2] * t.c.centre,
          weights[0] * t.a.radius + weights[1] * t.b.radius + weights[2] * t.c.radius};
}

/// How a point lies to an interpolated shape: which of its spheres comes nearest, and where it is touched.
struct Touch {
  double distance = 0;                                 ///< to the surface, exact, negative inside
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();   ///< outward, of unit length: the closest point's
  Eigen::Vector3d weights = Eigen::Vector3d::UnitX();  ///< of the spheres a, b, c in the sphere that is touched
};

/// The closest point of the surface to the point that was asked about.
[[nodiscard]] inline Eigen::Vector3d closest_point(const Eigen::Vector3d& point, const Touch& touch) noexcept {
  return point - touch.distance * touch.normal;
}

///@{
/// The nearest interpolated sphere. Of several, one is chosen.
[[nodiscard]] Touch touch(const Sphere& sphere, const Eigen::Vector3d& point) noexcept;
[[nodiscard]] Touch touch(const SphereEdge& edge, const Eigen::Vector3d& point) noexcept;
[[nodiscard]] Touch touch(const SphereTriangle& triangle, const Eigen::Vector3d& point) noexcept;
///@}

/// Distance from a point to the surface, exact, negative inside.
[[nodiscard]] double signed_distance(const SphereTriangle& triangle, const Eigen::Vector3d& point) noexcept;

/// A crossing of a ray and an interpolated shape: the point is origin + t direction.
struct Crossing {
  double t = 0;                                        ///< how far along the ray
  Eigen::Vector3d weights = Eigen::Vector3d::UnitX();  ///< of the interpolated sphere that is touched there
};

/// The part of a line that lies within a convex shape; either end may lie behind the origin.
struct Passage {
  Crossing entry;  ///< at the smaller t
  Crossing exit;   ///< at the larger t
};

///@{
/// Where the line of a ray passes through.
[[nodiscard]] std::optional<Passage> passage(const Sphere& sphere, const Ray& ray) noexcept;
[[nodiscard]] std::optional<Passage> passage(const SphereEdge& edge, const Ray& ray) noexcept;
[[nodiscard]] std::optional<Passage> passage(const SphereTriangle& triangle, const Ray& ray) noexcept;
///@}

/// The first crossing of the surface at t > 0: the entry for an origin outside, the exit for one inside.
[[nodiscard]] std::optional<Crossing> intersect(const SphereTriangle& triangle, const Ray& ray) noexcept;

/// The outward unit normals of the two planes that touch all three spheres, the one on the side of
/// (b - a) x (c - a) first. None where |g| >= 1 or the centres lie on a line.
[[nodiscard]] std::optional<std::array<Eigen::Vector3d, 2>> tangent_normals(const SphereTriangle& triangle) noexcept;

}  // namespace armature::sdk
