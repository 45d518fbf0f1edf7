#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include <armature/sdk/error.h>
#include <armature/sdk/hierarchy/hierarchy.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// The version that is written; others are refused.
inline constexpr std::uint32_t kHierarchyFileVersion = 2;

/// Reads a hierarchy from a .smh file. Refused, with the file and what was expected: a file of another kind or
/// version, one that is truncated, longer than it says, or altered (by its checksum), and contents that are no
/// hierarchy. What a file announces is held against its size before memory is taken for it.
[[nodiscard]] Expected<Hierarchy> read_hierarchy(const std::filesystem::path& path, const Task& task = {});

/// The same for the bytes of such a file. `name` stands for the file in messages.
[[nodiscard]] Expected<Hierarchy> parse_hierarchy(std::string_view bytes, std::string_view name);

/// Writes a hierarchy as .smh. The file appears once it is complete, or not at all.
[[nodiscard]] Expected<void> write_hierarchy(const Hierarchy& hierarchy, const std::filesystem::path& path);

/// The bytes of such a file: about 60 an input vertex.
[[nodiscard]] std::string encode_hierarchy(const Hierarchy& hierarchy);

}  // namespace armature::sdk
