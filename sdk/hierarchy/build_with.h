#pragma once

#include <cstddef>

#include <armature/sdk/hierarchy/build.h>
#include <armature/sdk/hierarchy/decimate_mesh.h>

#include "sdk/hierarchy/decimation.h"

namespace armature::sdk {

/// build_hierarchy() by steps of collapses that belong together, one at a time where `similar` is none.
[[nodiscard]] Expected<HierarchyBuild> build_hierarchy_with(SimilarCollapses* similar, const Mesh& mesh,
                                                            const HierarchyOptions& options, const Task& task);
/// decimate_mesh() likewise; `steps` becomes the number of collapses at the end of each, and stays where there is none.
[[nodiscard]] Expected<DecimatedMesh> decimate_mesh_with(SimilarCollapses* similar, std::vector<std::uint32_t>& steps,
                                                         const Mesh& mesh, const DecimateMeshOptions& options,
                                                         const Task& task);

}  // namespace armature::sdk
