#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <armature/sdk/error.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// What a mesh is like. Faces that name a vertex twice count as degenerate and are otherwise left out.
struct MeshReport {
  std::size_t vertices = 0;              ///< on a face or not
  std::size_t faces = 0;                 ///< degenerate ones included
  std::size_t edges = 0;                 ///< undirected
  std::size_t components = 0;            ///< parts without a common vertex; unused vertices are none
  std::size_t boundary_loops = 0;        ///< see `find_boundary_loops()`; chains between non-manifold edges included
  std::size_t boundary_edges = 0;        ///< of one face
  std::size_t nonmanifold_edges = 0;     ///< of three or more faces
  std::size_t nonmanifold_vertices = 0;  ///< see `find_pinched_vertices()`
  std::size_t degenerate_faces = 0;      ///< see `is_degenerate()`
  std::size_t duplicate_faces = 0;       ///< that have the corners of an earlier face, in any order
  std::size_t unused_vertices = 0;       ///< on no face
  std::size_t inward_faces = 0;          ///< see `find_inward_faces()`
  bool closed = false;                   ///< no edge has one face alone
  bool oriented = false;                 ///< see `is_oriented()`
  /// The number of handles, summed over the components, each boundary loop closed by a disc: (2 components - Euler
  /// characteristic - loops) / 2. Nothing where an edge or vertex is non-manifold, or the surface has one side only.
  std::optional<std::int64_t> genus = {};
  double bbox_diagonal = 0;  ///< see `bounding_box_diagonal()`
  double area = 0;           ///< of all faces
  double volume = 0;         ///< sum of `signed_volumes()`; what the surface encloses where it is closed and oriented
};

/// Looks at everything above. Takes time linear in the mesh, but for meshes with many nested components.
[[nodiscard]] Expected<MeshReport> analyse(const Mesh& mesh, const Task& task = {});

/// Whether a face names a vertex twice or its corners lie on a line: its height over its longest side is at most 1e-12
/// of that side.
[[nodiscard]] bool is_degenerate(const Mesh& mesh, FaceId face);

/// What every function relies on and readers guarantee: corners name positions, positions are finite, colours come for
/// all or none, and ids suffice. Fails with the first element that breaks it.
[[nodiscard]] Expected<void> validate(const Mesh& mesh);

}  // namespace armature::sdk
