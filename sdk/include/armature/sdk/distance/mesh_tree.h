#pragma once

#include <limits>
#include <memory>
#include <optional>

#include <Eigen/Core>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/spheremesh/primitives.h>

namespace armature::sdk {

/// A point of a mesh's surface. The face is not valid where nothing was found.
struct SurfacePoint {
  FaceId face;                                                ///< on which it lies
  Eigen::Vector3d point = Eigen::Vector3d::Zero();            ///< where it lies
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();      ///< weights of the face's corners; not negative, sum 1
  double distance = std::numeric_limits<double>::infinity();  ///< from the point that was asked about, not negative
};

/// Where a ray meets a mesh: at origin + t direction.
struct MeshHit {
  FaceId face;                                            ///< that is met
  double t = 0;                                           ///< how far along the ray
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();  ///< weights of the face's corners; sum 1
};

/// What a caller of MeshTree::closest knows beforehand. Neither changes what is found, only how fast.
struct SearchStart {
  double within = std::numeric_limits<double>::infinity();  ///< what lies farther away is not looked for
  FaceId hint = {};  ///< a face that is probably near, such as that of the last query close by
};

/// Exact closest points and ray hits on a triangle mesh, over a hierarchy of boxes. Degenerate faces count as the
/// segments or points that they are. It keeps what it needs: the mesh may change or go. Queries are thread-safe.
class MeshTree {
 public:
  /// Time n log n in the faces.
  explicit MeshTree(const Mesh& mesh);
  ~MeshTree();
  MeshTree(MeshTree&&) noexcept;
  MeshTree& operator=(MeshTree&&) noexcept;

  /// The closest point of the surface; no valid face if none lies within `start.within` or the mesh has no faces.
  [[nodiscard]] SurfacePoint closest(const Eigen::Vector3d& point, const SearchStart& start = {}) const noexcept;

  /// The first hit at t > 0.
  [[nodiscard]] std::optional<MeshHit> intersect(const Ray& ray) const noexcept;

  /// Whether the point is inside a closed mesh: how often faces wind around it, counted along three directions, two of
  /// which must agree on a number that is not zero. On an open mesh the holes let some points be taken for the other
  /// side. A mesh that is inside out has the same inside.
  [[nodiscard]] bool inside(const Eigen::Vector3d& point) const noexcept;

  /// Distance to the surface, negative inside a closed mesh.
  [[nodiscard]] double signed_distance(const Eigen::Vector3d& point) const noexcept {
    const double distance = closest(point).distance;
    return inside(point) ? -distance : distance;
  }

 private:
  struct State;
  std::unique_ptr<const State> state_;
};

}  // namespace armature::sdk
