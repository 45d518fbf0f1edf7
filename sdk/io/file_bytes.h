#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include <armature/sdk/error.h>

namespace armature::sdk {

/// Whether a file is there and may be read.
[[nodiscard]] Expected<void> check_readable(const std::filesystem::path& path);

/// A file as one string. The path stands before the reason of a failure.
[[nodiscard]] Expected<std::string> read_file_bytes(const std::filesystem::path& path);

/// Writes a whole file under a temporary name beside it and renames it when complete.
[[nodiscard]] Expected<void> write_file_bytes(const std::filesystem::path& path, std::string_view bytes);

}  // namespace armature::sdk
