#pragma once

#include <armature/sdk/distance/sphere_mesh_tree.h>
#include <armature/sdk/error.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/task.h>

#include "sdk/spheremesh/convex_union.h"

namespace armature::sdk {

/// Collapses edges of a closed manifold mesh whose vertices lie on the surface of a sphere-mesh, as long as mesh and
/// surface stay within `tolerance` (a length) of each other. The order and the new places come from quadrics (Garland
/// and Heckbert 1997) of the surface's own tangent planes, not the mesh's: so vertices move onto creases that the mesh
/// had cut off. Towards the surface, all of every new triangle is looked at; towards the mesh, all vertices that it
/// began with, each of which stays with the triangle nearest to it. `bodies` and `surface` are of the same sphere-mesh.
/// The result is closed and manifold again, and runs through itself nowhere where the mesh did not.
[[nodiscard]] Expected<Mesh> simplify_within(const Mesh& mesh, const SphereMeshTree& surface, const ConvexUnion& bodies,
                                             double tolerance, const Task& task);

}  // namespace armature::sdk
