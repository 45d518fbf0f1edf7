#include "tools/commands/spheremesh/inputs.h"

#include <utility>

#include <armature/sdk/deformation/deform.h>
#include <armature/sdk/hierarchy/hierarchy_file.h>
#include <armature/sdk/io/read_mesh.h>
#include <fmt/format.h>

#include "tools/sdk_call.h"

namespace armature::tools {

Expected<MeshWithHierarchy> read_mesh_with_hierarchy(const std::string& mesh_file, const std::string& hierarchy_file,
                                                     const sdk::Task& task) {
  auto mesh = ours(sdk::read_mesh(mesh_file, {}, task));
  if (!mesh) return tl::unexpected(mesh.error());
  auto hierarchy = ours(sdk::read_hierarchy(hierarchy_file, task));
  if (!hierarchy) return tl::unexpected(hierarchy.error());
  if (const auto same = sdk::check_same(*mesh, *hierarchy); !same)
    return fail(
        fmt::format("{}: does not belong to {}: {}; build it from this mesh with `spheremesh build --hierarchy`",
                    hierarchy_file, mesh_file, same.error().message));
  return MeshWithHierarchy{std::move(*mesh), std::move(*hierarchy)};
}

}  // namespace armature::tools
