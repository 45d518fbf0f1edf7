#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>

#include <armature/sdk/error.h>

namespace armature::sdk {

/// Whether a file is there and may be read.
[[nodiscard]] Expected<void> check_readable(const std::filesystem::path& path);

/// A file as one string, or its first `most` bytes. The path stands before the reason of a failure.
[[nodiscard]] Expected<std::string> read_file_bytes(const std::filesystem::path& path,
                                                    std::size_t most = std::numeric_limits<std::size_t>::max());

/// Writes a whole file under a temporary name beside it and renames it when complete.
[[nodiscard]] Expected<void> write_file_bytes(const std::filesystem::path& path, std::string_view bytes);

}  // namespace armature::sdk
