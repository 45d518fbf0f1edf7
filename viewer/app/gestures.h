#pragma once

#include "viewer/app/ui.h"

namespace armature::viewer {

/// Where in the view a pixel of the window is.
[[nodiscard]] ViewPoint view_point(const Ui& ui, const ImVec2& pixel);
void issue_camera(Ui& ui, const OrbitCamera& camera);

///@{
/// What the tool in hand does while a mouse button is down: it shows what it will do, and becomes a command in the end.
void begin_gesture(Ui& ui);
void continue_gesture(Ui& ui);
void end_gesture(Ui& ui);
///@}

/// Shows what the gesture would select so far, or how what it drags would lie, as soon as that is found. Call it once a
/// frame; whether there is more to be found.
bool follow_gesture(Ui& ui);

}  // namespace armature::viewer
