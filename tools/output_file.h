#pragma once

#include <string>
#include <string_view>

#include "firmware_host/error.h"

namespace armature::tools {

/// Writes a whole file under a temporary name beside it and renames it when complete.
[[nodiscard]] Expected<void> write_file(const std::string& path, std::string_view content);

}  // namespace armature::tools
