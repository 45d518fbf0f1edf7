#pragma once

#include <vector>

#include <armature/sdk/mesh/adjacency.h>
#include <armature/sdk/mesh/mesh.h>

namespace armature::sdk {

/// A walk along edges that have one face each.
struct BoundaryLoop {
  std::vector<VertexId> vertices = {};  ///< in the direction of the face at the first edge
  bool closed = true;                   ///< false for a chain between two edges of three or more faces
};

/// Finds the boundaries of a mesh, in the order of their first edges. Every boundary edge lies on one of them. A
/// boundary that touches itself or another in a vertex is not joined there: a walk follows the faces around the vertex.
[[nodiscard]] std::vector<BoundaryLoop> find_boundary_loops(const Mesh& mesh, const Adjacency& adjacency);

/// The vertices at which a mesh is pinched, ascending: their faces fall into several groups without a common edge.
[[nodiscard]] std::vector<VertexId> find_pinched_vertices(const Mesh& mesh, const Adjacency& adjacency);

}  // namespace armature::sdk
