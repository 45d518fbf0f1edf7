#pragma once

#include <armature/navproto/vocabulary.h>
#include <imgui.h>

namespace armature::viewer {

/// A figure that carries a motion out: `phase` in [-1, 1], 0 = at rest. Turning motions are seen from above, the others
/// from the front or from the side, whichever shows them.
void draw_motion_figure(ImDrawList& draw, const ImVec2& centre, float size, navproto::MotionId motion, float phase,
                        ImU32 colour, ImU32 accent);

/// Its name, for people.
[[nodiscard]] const char* motion_title(navproto::MotionId motion);
/// What to do, for people.
[[nodiscard]] const char* motion_advice(navproto::MotionId motion);

}  // namespace armature::viewer
