#pragma once

#include <filesystem>

#include <armature/sdk/error.h>

#include "viewer/render/image.h"

namespace armature::viewer {

/// The file appears once it is complete, or not at all.
[[nodiscard]] sdk::Expected<void> write_png(const Image& image, const std::filesystem::path& path);

}  // namespace armature::viewer
