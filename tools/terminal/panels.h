#pragma once

#include "tools/terminal/live_model.h"
#include "tools/terminal/screen.h"

namespace armature::tools {

/// A rectangle of cells.
struct Area {
  int column = 0;
  int row = 0;
  int width = 0;
  int height = 0;
};

/// Colours that mean the same in every panel.
namespace palette {
inline constexpr Rgb kText{201, 209, 217};
inline constexpr Rgb kDim{110, 118, 129};
inline constexpr Rgb kFrame{68, 76, 86};
inline constexpr Rgb kFaint{48, 54, 61};
inline constexpr Rgb kWalk{63, 205, 110};
inline constexpr Rgb kTurn{188, 140, 255};
inline constexpr Rgb kLeftSide{45, 212, 191};
inline constexpr Rgb kRightSide{250, 166, 60};
inline constexpr Rgb kMiddle{236, 242, 248};
inline constexpr Rgb kPath{88, 166, 255};
inline constexpr Rgb kWarning{240, 110, 100};
inline constexpr Rgb kWaiting{230, 190, 90};
}  // namespace palette

/// A frame with rounded corners and a title; the area inside of it.
Area draw_frame(Screen& screen, const Area& area, std::string_view title);

/// A scale from -1 to 1 with `value` on it, marks at +-`dead_zone` where that is positive, one row high.
struct Gauge {
  double value = 0;
  double dead_zone = 0;
  Rgb colour;
};
void draw_gauge(Screen& screen, int column, int row, int width, const Gauge& gauge);

/// The person from the front and, where there is room, from the side (facing left).
void draw_body(const LiveState& state, Screen& screen, const Area& area);
/// The eight motion values with their dead zones; the two that steer stand out.
void draw_motions(const LiveState& state, Screen& screen, const Area& area);
/// Both velocities and where they have led.
void draw_velocities(const LiveState& state, Screen& screen, const Area& area);
/// The camera's path seen from above; the camera's first view points up.
void draw_path(const LiveState& state, Screen& screen, const Area& area);

}  // namespace armature::tools
