#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/error.h>
#include <armature/sdk/expansion/expansion.h>
#include <armature/sdk/mesh/adjacency.h>
#include <armature/sdk/mesh/components.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// What a component is like, whatever its place, turn and size (thesis, section 5.4.1 and algorithm 1).
struct ComponentShape {
  /// The approximate shape context: how area spreads over 10 x 10 bins of the distance to the centre of the smallest
  /// enclosing ball, and of the angle between there and the normal.
  Histogram context = {};
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  ///< of the area
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< principal ones, by falling spread; columns, right-handed
  Eigen::Vector3d spread = Eigen::Vector3d::Zero();    ///< variances along these
  /// Means of x_i x_j x_k along the axes, over the cube of the root mean square radius, for 000, 001, 002, 011, 012,
  /// 022, 111, 112, 122, 222: what tells the two ends of an axis apart.
  std::array<double, 10> skew = {};
  double area = 0;    ///< of all faces
  double radius = 0;  ///< of the smallest enclosing ball
};

/// The components of a mesh (linked by edges): a click selects one, and the others are ranked by how much they are like
/// it. All is computed when the mesh is loaded. Refers to the mesh, which must outlive it unchanged. Thread-safe to
/// read.
class ComponentIndex {
 public:
  /// Takes time linear in the mesh. Uses all cores; the same on any number of them.
  [[nodiscard]] static Expected<ComponentIndex> build(const Mesh& mesh, const Adjacency& adjacency,
                                                      const Task& task = {});

  /// How many components there are.
  [[nodiscard]] std::size_t size() const noexcept { return shapes_.size(); }
  /// The faces of a component, ascending.
  [[nodiscard]] std::span<const FaceId> faces(std::size_t component) const noexcept {
    return std::span(faces_).subspan(starts_[component], starts_[component + 1] - starts_[component]);
  }
  /// What a component is like.
  [[nodiscard]] const ComponentShape& shape(std::size_t component) const noexcept { return shapes_[component]; }

  /// All faces of the component of a face, ascending. Refused for a face that is not there or names a vertex twice.
  [[nodiscard]] Expected<std::vector<FaceId>> select(FaceId face) const;
  /// All other components as matches of that of a face, scored by 1 - chi-square of their contexts, so that size, turn
  /// and mirroring do not matter; each comes with the motion onto the reference. Refused as by `select()`.
  [[nodiscard]] Expected<Expansion> expand(FaceId face) const;
  /// All components of this mesh as matches of one of another mesh, that of a face there.
  [[nodiscard]] Expected<Expansion> expand(const ComponentIndex& of, FaceId face) const;

 private:
  [[nodiscard]] Expected<std::uint32_t> component_of(FaceId face) const;

  const Mesh* mesh_ = nullptr;
  std::vector<std::uint32_t> of_face_;
  std::vector<std::size_t> starts_;  // into faces_, by component, and its end
  std::vector<FaceId> faces_;
  std::vector<ComponentShape> shapes_;
};

}  // namespace armature::sdk
