#pragma once

#include <string>

#include "tools/terminal/live_model.h"
#include "tools/terminal/screen.h"

namespace armature::tools {

/// Draws everything: state, body, motions, velocities, path. Made for 80x24 and larger; smaller screens show a part.
void draw_live_view(const LiveState& state, Screen& screen);

/// The same in one line, for logs.
[[nodiscard]] std::string live_line(const LiveState& state);

/// "steering", "stopped: tracking lost" and so on.
[[nodiscard]] std::string status_text(const LiveState& state);

}  // namespace armature::tools
