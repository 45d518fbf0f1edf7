#pragma once

#include <string_view>

#include <armature/sdk/error.h>
#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

// One parser a format, one source file a parser. Each takes the bytes of a whole file; `name` stands for it in
// messages. Points without normals are for the caller to refuse.
[[nodiscard]] Expected<MeshOrPoints> parse_obj(std::string_view text, std::string_view name, const Task& task);
[[nodiscard]] Expected<MeshOrPoints> parse_off(std::string_view text, std::string_view name, const Task& task);
[[nodiscard]] Expected<MeshOrPoints> parse_ply(std::string_view bytes, std::string_view name, const Task& task);
[[nodiscard]] Expected<Mesh> parse_stl(std::string_view bytes, std::string_view name, const Task& task);
[[nodiscard]] Expected<PointSet> parse_xyz(std::string_view text, std::string_view name, const Task& task);

}  // namespace armature::sdk
