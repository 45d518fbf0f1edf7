#pragma once

#include <armature/sdk/distance/sphere_mesh_tree.h>
#include <armature/sdk/error.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// Collapses edges of a closed manifold mesh whose vertices lie on the surface of a sphere-mesh, as long as mesh and
/// surface stay within `tolerance` (a length) of each other. The order and the new places come from quadrics (Garland
/// and Heckbert 1997) of the surface's own tangent planes, not the mesh's: so vertices move onto creases that the mesh
/// had cut off. Towards the surface, distances are taken at the new triangles; towards the mesh, at all vertices that
/// it began with, each of which stays with the triangle nearest to it. The result is closed and manifold again.
[[nodiscard]] Expected<Mesh> simplify_within(Mesh mesh, const SphereMeshTree& surface, double tolerance,
                                             const Task& task);

}  // namespace armature::sdk
