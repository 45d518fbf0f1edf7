#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include <armature/sdk/error.h>

namespace armature::viewer {

/// What a file is called, without its folders.
[[nodiscard]] std::string file_name(const std::filesystem::path& path);

/// Writes a whole file: under another name beside it, renamed once it is complete.
[[nodiscard]] sdk::Expected<void> write_text(const std::filesystem::path& path, std::string_view text);

}  // namespace armature::viewer
