#pragma once

#include <cstddef>

#include <armature/sdk/hierarchy/build.h>
#include <armature/sdk/hierarchy/decimate_mesh.h>
#include <armature/sdk/mesh/point_set.h>

#include "sdk/hierarchy/decimation.h"

namespace armature::sdk {

/// What spheres are fitted to: a mesh, or points and what joins them (`surface_of()`).
struct Fitted {
  const Mesh& mesh;
  const PointSet* points = nullptr;  ///< none: the mesh itself
};

/// build_hierarchy() by steps of collapses that belong together, one at a time where `similar` is none.
[[nodiscard]] Expected<HierarchyBuild> build_hierarchy_with(SimilarCollapses* similar, const Fitted& shape,
                                                            const HierarchyOptions& options, const Task& task);
/// decimate_mesh() likewise; `steps` becomes the number of collapses at the end of each, and stays where there is none.
[[nodiscard]] Expected<DecimatedMesh> decimate_mesh_with(SimilarCollapses* similar, std::vector<std::uint32_t>& steps,
                                                         const Mesh& mesh, const DecimateMeshOptions& options,
                                                         const Task& task);

}  // namespace armature::sdk
