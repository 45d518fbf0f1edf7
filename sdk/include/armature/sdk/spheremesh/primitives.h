#pragma once

#include <optional>

#include <Eigen/Core>

namespace armature::sdk {

/// A vertex of a sphere-mesh (Thiery, Guy, Boubekeur 2013; thesis, section 4.3). Any length unit, any frame.
struct Sphere {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< in the model's coordinates
  double radius = 0;                                 ///< not negative; 0 is a point
};

/// An edge of a sphere-mesh: the convex hull of its two spheres, that is all spheres interpolated linearly between
/// them. Where neither sphere holds the other, its side is a cone tangent to both: with g = (b.radius - a.radius) /
/// length the contact circles lie off the centres, at c - r g u with radius r sqrt(1 - g^2). Where one sphere holds the
/// other it is the larger sphere alone; equal spheres are a sphere.
struct SphereEdge {
  Sphere a;  ///< where the blend is 0
  Sphere b;  ///< where the blend is 1
};

/// The sphere at `blend` in [0, 1] along the edge.
[[nodiscard]] inline Sphere interpolated(const SphereEdge& edge, double blend) noexcept {
  return {(1 - blend) * edge.a.centre + blend * edge.b.centre, (1 - blend) * edge.a.radius + blend * edge.b.radius};
}

/// A half-line, along which crossings are looked for.
struct Ray {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();      ///< where it begins
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< of any length but zero
};

/// Where a ray crosses the surface of an edge.
struct RayHit {
  double t = 0;      ///< the point is origin + t direction
  double blend = 0;  ///< which interpolated sphere is touched there: 0 = a, 1 = b
};

///@{
/// Distance from a point to the surface, exact, negative inside.
[[nodiscard]] double signed_distance(const Sphere& sphere, const Eigen::Vector3d& point) noexcept;
[[nodiscard]] double signed_distance(const SphereEdge& edge, const Eigen::Vector3d& point) noexcept;
///@}

///@{
/// The first crossing of the surface at t > 0: the entry for an origin outside, the exit for one inside.
[[nodiscard]] std::optional<RayHit> intersect(const Sphere& sphere, const Ray& ray) noexcept;
[[nodiscard]] std::optional<RayHit> intersect(const SphereEdge& edge, const Ray& ray) noexcept;
///@}

/// The outward unit normal where a ray hit the edge.
[[nodiscard]] Eigen::Vector3d surface_normal(const SphereEdge& edge, const Ray& ray, const RayHit& hit) noexcept;

/// Casts many rays from one origin at one edge; what depends on the origin alone is computed once.
class EdgeCaster {
 public:
  /// Prepares for rays from `origin`.
  explicit EdgeCaster(const SphereEdge& edge, const Eigen::Vector3d& origin = Eigen::Vector3d::Zero()) noexcept;

  /// As intersect() of a ray from the origin.
  [[nodiscard]] std::optional<RayHit> cast(const Eigen::Vector3d& direction) const noexcept;

 private:
  Eigen::Vector3d to_a_, to_b_, axis_;  // from the origin to the centres; from a to b
  double inside_a_, inside_b_;          // |to_centre|^2 - radius^2: negative where the origin is inside
  double side_;                         // length^2 - (difference of radii)^2; <= 0: no cone between the spheres
  double cone_0_, taper_;               // constant and linear coefficients of the cone's quadratic
  double along_0_;                      // the origin's coordinate between the contact circles, in [0, side_] there
  bool has_a_, has_b_;                  // false for a sphere that the other one holds
};

}  // namespace armature::sdk
