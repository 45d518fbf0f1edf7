#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Geometry>
#include <armature/sdk/deformation/sphere_move.h>
#include <armature/sdk/error.h>
#include <armature/sdk/hierarchy/hierarchy.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// Spheres of a level about which the surface is like that about others, the reference.
struct SphereCounterpart {
  std::vector<SphereId> spheres;  ///< in the order of the reference's
  Eigen::Affine3d
      from_reference;  ///< rigid, or with a mirror: lays the surface about the reference on that about these
  /// How far the surface about a sphere lies from that about its counterpart then, of the worst of them: a mean, as a
  /// part of the spread of the sphere's region.
  double misfit;
};

/// What counts as a counterpart.
struct CounterpartOptions {
  double most_misfit = 0.1;  ///< positive
};

/// Counterparts of spheres of one level, the best first: other spheres that surface like theirs surrounds, once it is
/// turned, and mirrored if need be. Where turns fit equally well, as on a round leg, that one is taken by which the
/// whole mesh fits best. Hierarchies of `build_similar_hierarchy()` have spheres where their counterparts have some;
/// plain ones often have not. At the most one for any spheres, and none that shares a sphere with the reference; two
/// counterparts may share some. Deterministic. Fails for a hierarchy of another mesh, a level that it has not, no
/// spheres or one that is not there.
[[nodiscard]] Expected<std::vector<SphereCounterpart>> sphere_counterparts(const Mesh& mesh, const Hierarchy& hierarchy,
                                                                           std::size_t spheres,
                                                                           std::span<const SphereId> reference,
                                                                           const CounterpartOptions& options = {},
                                                                           const Task& task = {});

/// A move of the reference as one of a counterpart, in its own frame: mirrored where it is.
[[nodiscard]] SphereMove carried(const SphereMove& move, const SphereCounterpart& counterpart);

/// A share of a move, -1 for its opposite: of what it translates, turns and scales by. A radius that it sets stays.
[[nodiscard]] SphereMove share_of(const SphereMove& move, double share);

/// How counterparts follow moves that swing to and fro (thesis, section 7.2).
struct SwingOptions {
  /// In periods: the reference has moved by sin(2 pi time) of its moves, so a quarter is all of them.
  double time = 0.25;
  /// By how many periods counterparts lag behind, the best first and over again if they are more. Empty: none do.
  std::vector<double> phases = {};
  CounterpartOptions counterparts = {};  ///< what counts as one
};

/// Moves of one level, and after each what it is for the counterparts of its spheres; a move without spheres has none.
/// Of counterparts of a move that share spheres the best alone moves. Fails as `sphere_counterparts()`, for moves
/// that `check()` refuses, and for numbers that are not finite.
[[nodiscard]] Expected<std::vector<SphereMove>> with_counterparts(const Mesh& mesh, const Hierarchy& hierarchy,
                                                                  std::size_t spheres,
                                                                  std::span<const SphereMove> moves,
                                                                  const SwingOptions& options = {},
                                                                  const Task& task = {});

}  // namespace armature::sdk
