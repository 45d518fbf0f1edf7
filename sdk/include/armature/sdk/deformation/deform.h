#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <armature/sdk/deformation/heat_diffusion.h>
#include <armature/sdk/deformation/skinning.h>
#include <armature/sdk/deformation/sphere_move.h>
#include <armature/sdk/error.h>
#include <armature/sdk/hierarchy/hierarchy.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// Where the heat of a level starts from.
enum class WeightSource : std::uint8_t {
  Clusters,          ///< the vertices that each sphere stands for: see `SphereWeights`
  ClosestPrimitive,  ///< the thesis's: see `closest_primitive_weights()`
};

/// How a mesh follows its spheres.
struct DeformOptions {
  HeatOptions heat = {};                          ///< how weights spread
  WeightSource weights = WeightSource::Clusters;  ///< where they start from
  Blend blend = Blend::DualQuaternions;           ///< how motions are blended
  /// Where spheres only turn, each about an axis no farther away than all of them are long, by dual quaternions, a
  /// closed mesh has the volume afterwards that it had: see `SkinnedLevel::move()`. `deform()` takes its moves
  /// together: each of them has to be such turns, or what they come to. A session judges each move by itself, on the
  /// mesh as it then is.
  bool keep_volume = true;
};

/// Whether a hierarchy was built from a mesh: it has as many vertices, in the same places within rounding. Fails with
/// what differs.
[[nodiscard]] Expected<void> check_same(const Mesh& mesh, const Hierarchy& hierarchy);

/// The mesh after moves of the spheres of one level, one after the other. Vertices keep their order, and without moves
/// their bits. Fails for a hierarchy of another mesh, a level that it does not have, and moves that `check()` refuses,
/// naming their place.
[[nodiscard]] Expected<Mesh> deform(const Mesh& mesh, const Hierarchy& hierarchy, std::size_t spheres,
                                    std::span<const SphereMove> moves, const DeformOptions& options = {},
                                    const Task& task = {});

}  // namespace armature::sdk
