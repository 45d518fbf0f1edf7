#pragma once

#include <filesystem>
#include <string_view>

#include <armature/sdk/error.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

// assimp runs in a process of its own, forked for one file: a parser of it that crashes, hangs or exhausts memory on a
// hostile file costs that file alone. It is loaded there when it is needed, so that programs start without it.

/// Reads a file in any format that assimp knows, with the files it refers to.
[[nodiscard]] Expected<Mesh> read_by_assimp(const std::filesystem::path& path, const Task& task);

/// The same for the bytes of a file; the extension of `name` tells their format. Reads no file.
[[nodiscard]] Expected<Mesh> parse_by_assimp(std::string_view bytes, std::string_view name, const Task& task);

}  // namespace armature::sdk
