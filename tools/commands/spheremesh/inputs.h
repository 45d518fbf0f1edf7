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

/// What is wrong with the name of a mesh to write, for `CLI::Option::check`; empty if nothing is.
[[nodiscard]] std::string wrong_mesh_name(const std::string& path);
/// The same of a sphere-mesh.
[[nodiscard]] std::string wrong_sphere_mesh_name(const std::string& path);

}  // namespace armature::tools
