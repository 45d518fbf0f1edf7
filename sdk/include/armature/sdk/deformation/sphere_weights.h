#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <armature/sdk/deformation/heat_diffusion.h>
#include <armature/sdk/hierarchy/hierarchy.h>
#include <armature/sdk/mesh/ids.h>
#include <armature/sdk/mesh/mesh.h>

namespace armature::sdk {

/// How much a sphere moves the vertices that it reaches.
struct WeightColumn {
  std::vector<VertexId> vertices = {};  ///< ascending
  std::vector<float> weights = {};      ///< of each, in (0, 1]
};

/// What moves each vertex of a mesh: a column a sphere.
struct SkinWeights {
  std::vector<std::shared_ptr<const WeightColumn>> columns = {};  ///< by sphere
  std::vector<double> totals = {};  ///< [V]: the sum of all columns, positive; weights are parts of it

  /// Adds the columns up for so many vertices.
  [[nodiscard]] static SkinWeights of(std::vector<std::shared_ptr<const WeightColumn>> columns, std::size_t vertices);
  /// [V]: how much a sphere moves each vertex, in [0, 1]; all spheres together are 1 everywhere.
  [[nodiscard]] std::vector<double> of_sphere(std::size_t sphere) const;
};

/// The heat weights of all spheres of a hierarchy, each found when it is first asked for and kept. The heat of a sphere
/// starts from the vertices that it stands for; heat is linear, so a sphere's weights are the sum of its children's:
/// coarser levels cost nothing that is not there already, and a sphere that is split costs one solve about it. What a
/// sphere weighs depends on nothing but the mesh, the hierarchy and the options, whatever was asked for before. The
/// diffusion and the hierarchy must be of the same mesh and outlive it. Not thread-safe.
class SphereWeights {
 public:
  /// What is taken off every weight, so that each sphere reaches a few vertices only and fades out.
  static constexpr float kCut = 1.0F / 256;

  /// Finds no weights yet.
  SphereWeights(const HeatDiffusion& diffusion, const Hierarchy& hierarchy);

  /// Its weights. Every sphere has a share in all vertices that it stands for.
  [[nodiscard]] std::shared_ptr<const WeightColumn> of(NodeId node);
  /// The weights of some nodes of which none lies above another, and which together stand for all vertices; sphere i is
  /// node i.
  [[nodiscard]] SkinWeights of(std::span<const NodeId> nodes);

 private:
  void split(NodeId parent);

  const HeatDiffusion* diffusion_;
  const Hierarchy* hierarchy_;
  std::vector<std::shared_ptr<const WeightColumn>> columns_;  // by node; none where none was asked for
};

/// The thesis's weights (section 4.7.2) for the level with so many spheres, which the hierarchy must have: heat starts
/// from the sphere, edge or triangle nearest to a vertex, of those at the sphere that stands for it; the spheres of an
/// edge or a triangle share it as the nearest point lies. Not linear in the level: every one costs a solve a sphere.
[[nodiscard]] SkinWeights closest_primitive_weights(const HeatDiffusion& diffusion, const Hierarchy& hierarchy,
                                                    const Mesh& mesh, std::size_t spheres);

}  // namespace armature::sdk
