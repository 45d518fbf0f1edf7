#pragma once

#include <armature/sdk/distance/sphere_mesh_tree.h>
#include <armature/sdk/error.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/task.h>

#include "sdk/spheremesh/convex_union.h"

namespace armature::sdk {

/// How finely a surface is cut out, as lengths.
struct CutOptions {
  double coarse = 0;  ///< tetrahedra to begin with
  double fine = 0;    ///< tetrahedra that are not halved any more
  double finest = 0;  ///< nor those where a body ends thinner than `fine`
  double error = 0;   ///< how far triangles may leave the surface before their tetrahedron is halved
};

/// The outer surface as what it cuts out of adaptively halved tetrahedra: closed, manifold, oriented outwards; its
/// vertices lie on the surface. The walls of closed voids, and what floats in them, are left out. Tetrahedra are left
/// alone where no primitive reaches (each lies on one side of its tangent planes) or one covers all corners (each is
/// convex).
[[nodiscard]] Expected<Mesh> cut_surface(const ConvexUnion& bodies, const SphereMeshTree& tree,
                                         const CutOptions& options, const Task& task);

}  // namespace armature::sdk
