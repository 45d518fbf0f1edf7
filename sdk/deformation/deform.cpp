#include <algorithm>
#include <string>
#include <utility>

#include <armature/sdk/deformation/deform.h>
#include <armature/sdk/deformation/skinned_level.h>
#include <armature/sdk/deformation/sphere_weights.h>

#include "sdk/deformation/in_range.h"

namespace armature::sdk {

Expected<void> check_same(const Mesh& mesh, const Hierarchy& hierarchy) {
  if (mesh.positions.size() != hierarchy.leaf_count())
    return fail("the hierarchy is of another mesh: it has " + std::to_string(hierarchy.leaf_count()) +
                " vertices, the mesh " + std::to_string(mesh.positions.size()));
  constexpr double kRounding = 1e-6;  // of floats in units of the diagonal
  const auto& parts = hierarchy.parts();
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    if (!in_range(mesh.positions[v]))
      return fail("vertex " + std::to_string(v) + " is out of range; scale the mesh down");
    const auto& [x, y, z] = parts.leaves[v];
    const Eigen::Vector3d leaf = parts.origin + parts.scale * Eigen::Vector3d(x, y, z);
    if (!((leaf - mesh.positions[v]).norm() <= kRounding * parts.scale))
      return fail("the hierarchy is of another mesh: vertex " + std::to_string(v) + " lies elsewhere");
  }
  return {};
}

Expected<Mesh> deform(const Mesh& mesh, const Hierarchy& hierarchy, std::size_t spheres,
                      std::span<const SphereMove> moves, const DeformOptions& options, const Task& task) {
  if (const auto same = check_same(mesh, hierarchy); !same) return tl::unexpected(same.error());
  auto shape = hierarchy.level(spheres);
  if (!shape) return tl::unexpected(shape.error());
  for (std::size_t k = 0; k < moves.size(); ++k)
    if (const auto checked = check(moves[k], spheres); !checked)
      return fail("move " + std::to_string(k) + ", " + checked.error().message);
  const auto diffusion = HeatDiffusion::of(mesh, options.heat, task);
  if (!diffusion) return tl::unexpected(diffusion.error());
  task.report("weighing", 0);
  SkinWeights weights = options.weights == WeightSource::Clusters
                            ? SphereWeights(*diffusion, hierarchy).of(hierarchy.nodes_of_level(spheres))
                            : closest_primitive_weights(*diffusion, hierarchy, mesh, spheres);
  if (task.stopped()) return cancelled();
  auto motions = at_rest(shape->spheres);
  for (const SphereMove& move : moves) move_spheres(move, motions);
  // Of turns about several axes, one after the other, none may be left.
  const bool turns = std::ranges::all_of(moves, [&](const SphereMove& move) {
    auto alone = at_rest(shape->spheres);
    move_spheres(move, alone);
    return only_turn(alone);
  });
  const Volume volume = !options.keep_volume ? Volume::Free : turns ? Volume::Kept : Volume::KeptByTurns;
  SkinnedLevel level(std::move(weights), std::move(*shape), mesh);
  Mesh deformed = mesh;
  level.move(motions, options.blend, deformed.positions, volume);
  for (std::size_t v = 0; v < deformed.positions.size(); ++v)
    if (!in_range(deformed.positions[v]))
      return fail("the moves take vertex " + std::to_string(v) + " out of range; use smaller numbers");
  return deformed;
}

}  // namespace armature::sdk
