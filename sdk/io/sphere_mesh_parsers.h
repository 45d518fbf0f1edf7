#pragma once

#include <string_view>

#include <armature/sdk/error.h>
#include <armature/sdk/spheremesh/sphere_mesh.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

// Each takes the bytes of a whole file; `name` stands for it in messages.
[[nodiscard]] Expected<SphereMesh> parse_ma(std::string_view text, std::string_view name, const Task& task);
[[nodiscard]] Expected<SphereMesh> parse_sphere_ply(std::string_view bytes, std::string_view name, const Task& task);

}  // namespace armature::sdk
