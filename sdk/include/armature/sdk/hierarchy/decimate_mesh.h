#pragma once

#include <cstddef>
#include <vector>

#include <armature/sdk/error.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// How a mesh is decimated to a coarser mesh.
struct DecimateMeshOptions {
  std::size_t vertices = 0;  ///< to reach; fewer than there are components leaves one a component
  /// How strongly boundaries are held in place; 0 lets them shrink.
  double boundary_weight = 1;
  bool penalise_flips = true;  ///< collapses that turn a triangle over come last
  bool keep_topology = false;  ///< only collapses that keep it; ends where there are none left
};

/// A coarser mesh and where it comes from.
struct DecimatedMesh {
  Mesh mesh;                      ///< without colours; vertices and triangles in the order of the input
  std::vector<VertexId> came_to;  ///< by input vertex: the vertex of `mesh` that it was drawn into
};

/// Decimates by the quadric error metric of Garland and Heckbert (1997), in the same framework as build_hierarchy():
/// the baseline that sphere-meshes are held against (thesis, table 4.1). Triangles that become the same, or lose a
/// side, are dropped; what is left may be non-manifold unless the topology is kept. Deterministic.
[[nodiscard]] Expected<DecimatedMesh> decimate_mesh(const Mesh& mesh, const DecimateMeshOptions& options,
                                                    const Task& task = {});

}  // namespace armature::sdk
