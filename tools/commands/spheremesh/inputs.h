#pragma once

#include <string>

#include <armature/sdk/hierarchy/hierarchy.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/task.h>

#include "firmware_host/error.h"

namespace armature::tools {

/// A mesh and its hierarchy.
struct MeshWithHierarchy {
  sdk::Mesh mesh;            ///< as its file has it
  sdk::Hierarchy hierarchy;  ///< built from it
};

/// Reads both; fails, with what to do, if they do not belong together.
[[nodiscard]] Expected<MeshWithHierarchy> read_mesh_with_hierarchy(const std::string& mesh_file,
                                                                   const std::string& hierarchy_file,
                                                                   const sdk::Task& task);

}  // namespace armature::tools
