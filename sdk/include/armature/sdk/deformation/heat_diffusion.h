#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/error.h>
#include <armature/sdk/laplacian/sparse_factor.h>
#include <armature/sdk/mesh/ids.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// How far apart two spheres blend into one another.
struct HeatOptions {
  /// Weights fall by a factor e over so much of the bounding box's diagonal: 1 / sqrt(lambda). Positive.
  double reach = 0.03;
};

/// Heat that spreads over a surface from where it is set (Baran and Popovic 2007; thesis, section 4.7.2):
/// (L + lambda M) w = lambda M p, with the Laplacian of `laplacian()` and the lumped mass M. Factored once a mesh; the
/// map from p to w is linear, keeps sums (p = 1 gives w = 1) and bounds (p in [0, 1] gives w in [0, 1]). What does not
/// hang together by faces does not mix; a vertex on no face keeps its own value. Thread-safe to read.
class HeatDiffusion {
 public:
  /// Fails for a reach that is no positive number. Takes any mesh.
  [[nodiscard]] static Expected<HeatDiffusion> of(const Mesh& mesh, const HeatOptions& options = {},
                                                  const Task& task = {});

  /// How many vertices there are.
  [[nodiscard]] std::size_t size() const noexcept { return factor_.size(); }
  /// Overwrites p with w; [V] or [V][k], a column a function.
  void diffuse(Eigen::Ref<Eigen::MatrixXd> p) const;
  /// w for the indicator of some vertices, at some vertices: out[i] is its value at wanted[i]. Cheap where they lie
  /// close together.
  void diffuse(std::span<const VertexId> vertices, std::span<const VertexId> wanted, std::span<double> out) const;

 private:
  HeatDiffusion(SparseFactor factor, Eigen::VectorXd source) : factor_(std::move(factor)), source_(std::move(source)) {}

  SparseFactor factor_;
  Eigen::VectorXd source_;  // lambda M; 1 for a vertex on no face
};

}  // namespace armature::sdk
