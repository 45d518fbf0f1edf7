#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>

#include <Eigen/Core>
#include <armature/sdk/spheremesh/sphere_mesh.h>
#include <armature/sdk/spheremesh/sphere_triangle.h>

namespace armature::sdk {

/// The spheres that an interpolated sphere blends: three of a triangle, two of an edge or one; the rest is not valid.
using TouchedSpheres = std::array<SphereId, 3>;

/// The interpolated sphere of a sphere-mesh that comes nearest to a point.
struct NearestSphere {
  /// To the surface of the primitive. Outside, this is the exact distance to the union. Inside it is negative and its
  /// size only a lower bound of the distance to the surface of the union (OuterSurface knows that one).
  double distance = std::numeric_limits<double>::infinity();
  TouchedSpheres spheres = {};                        ///< which it blends
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();  ///< of these spheres; not negative, sum 1
  Sphere sphere = {};                                 ///< the interpolated sphere itself
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< from its centre to the point; any where both coincide
};

/// Where a ray crosses the surface of a sphere-mesh: at origin + t direction.
struct SphereMeshHit {
  double t = 0;                                       ///< how far along the ray
  TouchedSpheres spheres = {};                        ///< of the interpolated sphere that is met
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();  ///< of these spheres; not negative, sum 1
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< outward, of unit length
};

class OuterSurface;

/// Distances and ray hits against the union of all interpolated spheres of a sphere-mesh, over a hierarchy of boxes of
/// its spheres, edges and triangles. It keeps what it needs: the sphere-mesh may change or go. Queries are thread-safe.
class SphereMeshTree {
 public:
  /// The corners of edges and triangles must name spheres. Spheres on no edge count on their own.
  explicit SphereMeshTree(const SphereMesh& shape);
  ~SphereMeshTree();
  SphereMeshTree(SphereMeshTree&&) noexcept;
  SphereMeshTree& operator=(SphereMeshTree&&) noexcept;

  /// The nearest interpolated sphere, by signed distance. The distance is infinite if the sphere-mesh is empty.
  [[nodiscard]] NearestSphere nearest(const Eigen::Vector3d& point) const noexcept;
  /// The distance of nearest() alone.
  [[nodiscard]] double signed_distance(const Eigen::Vector3d& point) const noexcept;
  /// Whether the point lies deeper than `depth` within a sphere, edge or triangle.
  [[nodiscard]] bool inside(const Eigen::Vector3d& point, double depth = 0) const noexcept;

  /// The first crossing of the union's surface at t > 0: the entry for an origin outside, the exit for one inside,
  /// which allocates.
  [[nodiscard]] std::optional<SphereMeshHit> intersect(const Ray& ray) const;

  /// The corners of the bounding box of the union, lower and upper.
  [[nodiscard]] std::array<Eigen::Vector3d, 2> bounds() const noexcept;

 private:
  friend class OuterSurface;  // looks through the same pieces and boxes
  struct State;
  std::unique_ptr<const State> state_;
};

}  // namespace armature::sdk
