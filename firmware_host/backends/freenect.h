#pragma once

#include <filesystem>
#include <memory>

#include "firmware_host/depth_source.h"

namespace armature {

[[nodiscard]] Expected<std::unique_ptr<DepthSource>> open_fakenect(const std::filesystem::path& directory,
                                                                   const OpenOptions& options);

}  // namespace armature
