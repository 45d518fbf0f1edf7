#pragma once

#include <memory>
#include <string>

#include "firmware_host/depth_source.h"

namespace armature::tools {

/// The depth that a running daemon publishes, as a source: `feed:ENDPOINT`. Waits for its first frame for at most
/// OpenOptions::wait_for_device. Frames whose time does not go on are passed over.
[[nodiscard]] Expected<std::unique_ptr<DepthSource>> open_feed(const std::string& endpoint,
                                                               const OpenOptions& options = {});

inline constexpr std::string_view kFeedScheme = "feed:";

}  // namespace armature::tools
