#pragma once

#include <filesystem>
#include <memory>

#include "firmware_host/depth_source.h"

namespace armature {

/// `oni:FILE`: an OpenNI2 recording, played by OpenNI2's own player. Every frame, in order, bit for bit; the end of the
/// stream is known from the file and always comes. The file's structure is checked before OpenNI2 sees it, and each
/// image before it is played, so a hostile file is an error and nothing else. Intrinsics come from `FILE.oni.toml`, or,
/// where there is none, from the field of view with the centre at (width/2, height/2).
[[nodiscard]] Expected<std::unique_ptr<DepthSource>> open_oni(const std::filesystem::path& path,
                                                              const OpenOptions& options);

}  // namespace armature
