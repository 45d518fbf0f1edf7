#pragma once

#include <imgui.h>

namespace armature::viewer::theme {

// One accent; the rest is ink on paper.
inline constexpr ImU32 kInk = IM_COL32(38, 44, 54, 255);
inline constexpr ImU32 kDim = IM_COL32(112, 118, 128, 255);
inline constexpr ImU32 kFaint = IM_COL32(206, 209, 213, 255);
inline constexpr ImU32 kAccent = IM_COL32(36, 104, 188, 255);
inline constexpr ImU32 kAccentFaint = IM_COL32(36, 104, 188, 60);
inline constexpr ImU32 kPaper = IM_COL32(250, 250, 248, 255);
inline constexpr ImU32 kVeil = IM_COL32(250, 250, 248, 226);
inline constexpr ImU32 kBad = IM_COL32(186, 52, 40, 255);
inline constexpr ImU32 kGood = IM_COL32(50, 140, 78, 255);

/// Colours, spacing and fonts for a display of that scale. Call before the first frame.
void apply(float scale);

///@{
/// Larger and heavier letters, where a font was found.
[[nodiscard]] ImFont* heading();
[[nodiscard]] ImFont* large();
///@}

}  // namespace armature::viewer::theme
