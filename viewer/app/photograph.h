#pragma once

#include <string>

#include <armature/sdk/error.h>

#include "viewer/app/app.h"

namespace armature::viewer {

/// Writes what a window of that size would show, or prints what pictures of a turn take; its context must be current.
/// Fails where OpenGL or the file does.
[[nodiscard]] sdk::Expected<void> photograph(App& app, Session& session, const PictureRequest& request,
                                             const PictureSize& size);

}  // namespace armature::viewer
