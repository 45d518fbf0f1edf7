#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/distance/sphere_mesh_tree.h>
#include <armature/sdk/error.h>
#include <armature/sdk/spheremesh/sphere_mesh.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// How finely OuterSurface looks.
struct OuterSurfaceOptions {
  /// How far a computed crease may leave the true one; with it the distances from inside. Of the bounding box diagonal.
  double tolerance = 1e-6;
  /// Size of the cells in which creases are looked for: parts of the surface smaller than this may be missed. Of the
  /// bounding box diagonal.
  double resolution = 2e-3;
  /// Cells along the longest side of the bounding box of the grid that tells closed voids: one whose way out is
  /// narrower than a cell counts as closed.
  int cavity_grid = 256;
  /// Creases are traced around each point that is asked about, not all of them beforehand: the same distances, sooner
  /// for a few thousand points of very many spheres. creases() is then empty.
  bool creases_when_asked = false;
};

/// A point of the outer surface of a sphere-mesh.
struct OuterSample {
  Eigen::Vector3d point;    ///< where it lies
  Eigen::Vector3d normal;   ///< outward, of unit length
  TouchedSpheres spheres;   ///< of the interpolated sphere that it lies on
  Eigen::Vector3d weights;  ///< of these spheres; not negative, sum 1
};

/// A straight piece of a crease of the outer surface, where two primitives meet at an angle.
struct OuterCrease {
  Eigen::Vector3d a;  ///< one end
  Eigen::Vector3d b;  ///< the other end
};

/// The boundary of the union of all interpolated spheres towards infinity. Closed voids inside do not count: they are
/// taken for filled.
///
/// From outside, the nearest primitive is the nearest surface. From inside it is not: what a primitive shows there may
/// lie within another. So the surface is known by its parts. Each primitive's own sphere, cone or facet has at most one
/// closest point that can be a local minimum, given in closed form, which counts where nothing covers it; else the
/// closest point lies on a crease, and creases are found beforehand as polylines. Queries are thread-safe; what is not
/// noexcept allocates.
class OuterSurface {
 public:
  /// Finds creases and voids. Edges and triangles of `shape` must name its spheres.
  explicit OuterSurface(const SphereMesh& shape, const OuterSurfaceOptions& options = {});
  /// The same, which takes seconds for a hundred thousand spheres; fails where it is cancelled.
  [[nodiscard]] static Expected<OuterSurface> build(const SphereMesh& shape, const OuterSurfaceOptions& options,
                                                    const Task& task);
  ~OuterSurface();
  OuterSurface(OuterSurface&&) noexcept;
  OuterSurface& operator=(OuterSurface&&) noexcept;

  /// Distance to the outer surface, negative within it; infinite if the sphere-mesh is empty.
  [[nodiscard]] double signed_distance(const Eigen::Vector3d& point) const;

  /// About `count` points, spread evenly by area and the same on every run; plus none on creases.
  [[nodiscard]] std::vector<OuterSample> sample(std::size_t count) const;

  /// All creases, in no particular order; each appears twice, once for either primitive.
  [[nodiscard]] const std::vector<OuterCrease>& creases() const noexcept;

  /// Whether the sphere-mesh holds closed voids wider than a cell.
  [[nodiscard]] bool has_cavities() const noexcept;

  /// Distances to the primitives.
  [[nodiscard]] const SphereMeshTree& tree() const noexcept;

 private:
  struct State;
  explicit OuterSurface(std::unique_ptr<const State> state);
  std::unique_ptr<const State> state_;
};

}  // namespace armature::sdk
