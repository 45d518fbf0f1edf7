#pragma once

#include <string>
#include <vector>

#include <armature/sdk/error.h>

#include "viewer/session/script.h"

namespace armature::viewer {

/// How the window is opened.
struct RunOptions {
  PictureSize size{1280, 800};          ///< in units of layout with a window, in pixels without one
  float scale = 0;                      ///< pixels a unit of layout; 0: as the display says
  std::vector<std::string> files = {};  ///< to be opened before the script is played
  std::string screenshot = {};          ///< without a window: what to write when the script is done
};

/// Shows the session in a window until it is closed; what cannot be opened, and a script that fails, are told there.
/// Fails where there is no display or no OpenGL 3.3.
[[nodiscard]] sdk::Expected<void> run_window(Session& session, Script script, const RunOptions& options);
/// Plays the script without a window or a display and writes pictures where it or the options ask for them; without any
/// picture it needs no OpenGL either. Fails where a file cannot be opened or the script fails.
[[nodiscard]] sdk::Expected<void> run_headless(Session& session, Script script, const RunOptions& options);

}  // namespace armature::viewer
