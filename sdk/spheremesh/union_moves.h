#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <armature/sdk/spheremesh/sphere_mesh.h>

#include "sdk/spheremesh/shape_edits.h"
#include "sdk/spheremesh/union_fit.h"

namespace armature::sdk {

/// Changes of a sphere-mesh's connectivity, judged by what they do to the loss close by, before anything is moved. Each
/// looks at one sphere-mesh as it is; when that changes, look again. The outer space may be that of a shape not much
/// different.
class UnionMoves {
 public:
  UnionMoves(const UnionFit& fit, const SphereMesh& shape, const OuterSpace& outer, const std::vector<bool>& fixed);

  /// Takes away triangles and wire edges that cost more than they are worth, turns edges inside quadrilaterals and
  /// fills rings of three, the best ones first and no two at the same sphere. The number of changes.
  [[nodiscard]] std::size_t repair(SphereMesh& shape);

  /// Adds a sphere where the union is farthest from the input, away from `taken` places, which it adds its own to.
  /// Empty if there is nowhere to go.
  [[nodiscard]] std::optional<SphereMesh> with_another_sphere(std::vector<Eigen::Vector3d>& taken) const;

  /// Makes `count` pairs of neighbours one sphere each, those that cost least; no two close to one another. Fewer if
  /// there are no more. The new sphere-mesh.
  [[nodiscard]] SphereMesh with_fewer_spheres(std::size_t count) const;

 private:
  struct Edit;
  struct Collapse;

  [[nodiscard]] static SphereMesh applied(const SphereMesh& shape, const Edit& edit);
  [[nodiscard]] std::vector<Edit> edits() const;
  [[nodiscard]] double gain(const Edit& edit) const;
  [[nodiscard]] bool fixed(SphereId id) const { return !fixed_.empty() && fixed_[id.index()]; }
  /// What a sample that touched_by_ names stands for, at this distance.
  [[nodiscard]] double cost(std::uint32_t sample, double distance) const;
  [[nodiscard]] double forward_cost(const SphereMesh& shape, std::span<const std::uint32_t> samples) const;
  [[nodiscard]] double back_cost(const SphereMesh& shape, const std::vector<std::uint32_t>& corners) const;
  /// The pieces that an edit takes away or hides: it saves no more than they cost as boundary.
  [[nodiscard]] std::vector<std::uint32_t> at_stake(const Edit& edit) const;
  /// What an edit adds: triangles of its spheres, or nothing.
  [[nodiscard]] SphereMesh added(const Edit& edit) const;
  /// What an edit gains seen from the input; `after` is the part around it as it leaves it.
  [[nodiscard]] double forward_gain(const Edit& edit, const std::vector<std::uint32_t>& stake,
                                    const SphereMesh& after) const;
  void find_collapse(Collapse& collapse) const;
  void add_back_cost(Collapse& collapse) const;
  [[nodiscard]] double inscribed_radius(std::size_t sample) const;
  [[nodiscard]] std::optional<std::size_t> farthest_place(const std::vector<Eigen::Vector3d>& taken) const;
  [[nodiscard]] std::vector<SphereMesh> ways_to_add(const ShapePart& part, std::size_t sample,
                                                    const Sphere& ball) const;
  [[nodiscard]] double settle(SphereMesh& shape, const ShapePart& part, std::span<const std::uint32_t> samples) const;

  const UnionFit& fit_;
  const SphereMesh& shape_;
  const std::vector<bool>& fixed_;
  UnionGauge gauge_;
  const OuterSpace& outer_;
  Stars stars_;
  std::vector<UnionTouch> touches_;                     // by sample
  std::vector<std::vector<std::uint32_t>> touched_by_;  // samples by sphere
  std::vector<double> back_costs_;                      // by piece
};

}  // namespace armature::sdk
