#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/error.h>
#include <armature/sdk/laplacian/laplacian.h>
#include <armature/sdk/laplacian/sparse_factor.h>
#include <armature/sdk/mesh/components.h>
#include <armature/sdk/selection/surface.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

class LevelTree;

/// What selecting parts needs of a surface, found once when it is loaded. Refers to the surface, which must outlive it.
/// Thread-safe to read.
class PartModel {
 public:
  /// Takes time about n log n in the mesh. Uses all cores; the same on any number of them.
  [[nodiscard]] static Expected<PartModel> build(const Surface& surface, const Task& task = {});

  /// Which it is about: the one that it was built from, or the same without noise where that is noisy. Faces and
  /// vertices have the same ids on both.
  [[nodiscard]] const Surface& surface() const noexcept { return *surface_; }
  /// Of the mesh.
  [[nodiscard]] const Laplacian& laplacian() const noexcept { return laplacian_; }
  /// Of L + eps M, with eps so small that harmonic fields do not feel it: M adds up to a millionth in each component.
  [[nodiscard]] const SparseFactor& factor() const noexcept { return factor_; }
  /// The parts of the mesh that hang together by vertices.
  [[nodiscard]] const Components& components() const noexcept { return components_; }
  /// The conformal factor at every vertex (Ben-Chen and Gotsman 2008; thesis, section 5.4.2): how much the surface must
  /// stretch there for its Gaussian curvature to become constant. High on what protrudes, the same after bending and at
  /// any size, of mean 0 over the area of each component.
  [[nodiscard]] const Eigen::VectorXd& conformal_factor() const noexcept { return conformal_factor_; }
  /// How the isolines of the conformal factor nest, for `expand_part()`.
  [[nodiscard]] const LevelTree& level_tree() const noexcept { return *level_tree_; }
  /// How far from a stroke through a face its constraints lie: 1 % of the diagonal of the face's component or 1.5 of
  /// its mean edges, whichever is more.
  [[nodiscard]] double offset(FaceId face) const noexcept {
    const std::uint32_t component = components_.of_face[face.index()];
    return component == Components::kNone ? 0 : offsets_[component];
  }

 private:
  struct Calm {
    explicit Calm(Mesh of) : mesh(std::move(of)), surface(mesh) {}
    Mesh mesh;
    Surface surface;
  };
  PartModel(const Surface& surface, std::shared_ptr<const Calm> calm, Laplacian laplacian, SparseFactor factor);

  std::shared_ptr<const Calm> calm_;  // or none
  const Surface* surface_;
  Laplacian laplacian_;
  SparseFactor factor_;
  Components components_;
  Eigen::VectorXd conformal_factor_;
  std::shared_ptr<const LevelTree> level_tree_;
  std::vector<double> offsets_;  // by component
};

}  // namespace armature::sdk
