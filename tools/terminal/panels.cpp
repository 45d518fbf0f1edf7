#include "tools/terminal/panels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "tools/terminal/braille.h"

namespace armature::tools {
namespace {

using navproto::kMotionCount;
using navproto::MotionId;

template <class... Args>
std::string formatted(const char* format, Args... args) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), format, args...);
  return text.data();
}

constexpr double kDegrees = 180 / std::numbers::pi;

Rgb motion_colour(const navproto::NavigationMessage& navigation, MotionId motion) {
  if (motion == navigation.walk_motion) return palette::kWalk;
  if (motion == navigation.turn_motion) return palette::kTurn;
  return {120, 150, 185};
}

void draw_speed(Screen& screen, const Area& area, int row, const char* name, const std::string& value, double share,
                Rgb colour) {
  screen.put(area.column + 1, row, name, {colour, true});
  screen.put(area.column + area.width - 1 - columns_of(value), row, value, {palette::kText, true});
  draw_gauge(screen, area.column + 1, row + 1, area.width - 2, {share, 0, colour});
}

/// The smallest of the steps 4, 6, 8, 12, 16, ... metres that holds `extent`, so that a map keeps its scale for a
/// while.
double map_span(double extent) {
  double span = 4;
  bool third = false;
  while (span < extent && span < 1e6) {
    span = third ? span * 4 / 3 : span * 3 / 2;
    third = !third;
  }
  return span;
}

struct Extent {
  double low = 0, high = 0;
  void hold(double v) { low = std::min(low, v), high = std::max(high, v); }
  [[nodiscard]] double middle() const { return (low + high) / 2; }
  [[nodiscard]] double length() const { return high - low; }
};

}  // namespace

Area draw_frame(Screen& screen, const Area& area, std::string_view title) {
  const Style line{palette::kFrame, false};
  const int right = area.column + area.width - 1;
  const int bottom = area.row + area.height - 1;
  for (int c = area.column + 1; c < right; ++c) {
    screen.put(c, area.row, U'─', line);
    screen.put(c, bottom, U'─', line);
  }
  for (int r = area.row + 1; r < bottom; ++r) {
    screen.put(area.column, r, U'│', line);
    screen.put(right, r, U'│', line);
  }
  screen.put(area.column, area.row, U'╭', line);
  screen.put(right, area.row, U'╮', line);
  screen.put(area.column, bottom, U'╰', line);
  screen.put(right, bottom, U'╯', line);
  if (!title.empty()) {
    screen.put(area.column + 2, area.row, U' ');
    const int end = screen.put(area.column + 3, area.row, title, {palette::kDim, true}, area.width - 6);
    screen.put(end, area.row, U' ');
  }
  return {area.column + 1, area.row + 1, area.width - 2, area.height - 2};
}

void draw_gauge(Screen& screen, int column, int row, int width, const Gauge& gauge) {
  if (width < 5) return;
  const int half = (width - 1) / 2;
  const int centre = column + half;
  for (int c = centre - half; c <= centre + half; ++c) screen.put(c, row, U'─', {palette::kFaint, false});
  // In half cells from the centre, whose own cell is not part of the scale.
  const double value = std::isfinite(gauge.value) ? std::clamp(gauge.value, -1.0, 1.0) : 0;
  const int halves = static_cast<int>(std::lround(std::abs(value) * half * 2));
  const int step = value < 0 ? -1 : 1;
  const Style bar{gauge.colour, true};
  for (int h = 0; h < halves / 2; ++h) screen.put(centre + step * (h + 1), row, U'━', bar);
  if (halves % 2 == 1) screen.put(centre + step * (halves / 2 + 1), row, value < 0 ? U'╺' : U'╸', bar);
  if (gauge.dead_zone > 0 && gauge.dead_zone < 1) {
    const int mark = std::max(1, static_cast<int>(std::lround(gauge.dead_zone * half)));
    for (const int side : {-1, 1}) {
      const bool covered = side == step && halves / 2 >= mark;
      screen.put(centre + side * mark, row, U'┊', covered ? bar : Style{palette::kDim, false});
    }
  }
  screen.put(centre, row, U'│', {palette::kDim, false});
}

void draw_motions(const LiveState& state, Screen& screen, const Area& area) {
  const Area inside = draw_frame(screen, area, "motions");
  const bool there = state.navigation.has_value() && state.fresh;
  constexpr int kNameWidth = 17;
  constexpr int kValueWidth = 13;
  const int gauge_width = inside.width - kNameWidth - kValueWidth - 2;
  const int spacing = inside.height >= 2 * static_cast<int>(kMotionCount) ? 2 : 1;
  for (std::size_t m = 0; m < kMotionCount; ++m) {
    const int row = inside.row + static_cast<int>(m) * spacing + (spacing == 2 ? 1 : 0);
    if (row >= inside.row + inside.height) break;
    const auto motion = static_cast<MotionId>(m);
    const navproto::NavigationMessage nothing;
    const auto& navigation = state.navigation ? *state.navigation : nothing;
    const auto& value = navigation.motions[m];
    const bool steers = motion == navigation.walk_motion || motion == navigation.turn_motion;
    const Rgb colour = motion_colour(navigation, motion);
    std::string name(navproto::kMotionNames[m]);
    std::replace(name.begin(), name.end(), '_', ' ');
    screen.put(inside.column + 1, row, name, {steers ? colour : palette::kText, steers}, kNameWidth);

    const double shown = there ? value.normalised : 0;
    const double alpha = state.alpha[m].value_or(0);
    const bool active = there && value.shaped != 0;
    draw_gauge(screen, inside.column + kNameWidth + 1, row, gauge_width,
               {shown, alpha, active ? colour : mixed(palette::kFaint, colour, steers ? 0.6 : 0.45)});
    const std::string numbers = there ? formatted("%+5.2f %+4.0f°", shown, value.angle_rad * kDegrees) : "    -     -";
    screen.put(inside.column + inside.width - kValueWidth + 1, row, numbers,
               {active ? colour : palette::kDim, active && steers}, kValueWidth);
  }
}

void draw_velocities(const LiveState& state, Screen& screen, const Area& area) {
  const Area inside = draw_frame(screen, area, "velocity");
  const bool there = state.navigation.has_value() && state.fresh;
  const int spacing = inside.height >= 10 ? 3 : 2;
  draw_speed(screen, inside, inside.row + (spacing == 3 ? 1 : 0), "walk",
             formatted("%+.2f m/s", state.velocity.linear_m_s), there ? state.navigation->walk : 0, palette::kWalk);
  // A turn to the left is positive and drawn to the left.
  draw_speed(screen, inside, inside.row + spacing + (spacing == 3 ? 1 : 0), "turn",
             formatted("%+.0f °/s", state.velocity.angular_rad_s * kDegrees), there ? -state.navigation->turn : 0,
             palette::kTurn);
  const std::array<std::pair<const char*, std::string>, 3> facts = {{
      {"walked", formatted("%.1f m", state.walked_m)},
      {"at", formatted("%.1f %.1f m", state.camera.x_m, state.camera.y_m)},
      {"heading", formatted("%.0f°", state.camera.heading_rad * kDegrees)},
  }};
  int row = inside.row + 2 * spacing + 1;
  for (const auto& [name, value] : facts) {
    if (row >= inside.row + inside.height) break;
    screen.put(inside.column + 1, row, name, {palette::kDim, false});
    screen.put(inside.column + inside.width - 1 - columns_of(value), row, value, {palette::kText, false});
    ++row;
  }
}

void draw_path(const LiveState& state, Screen& screen, const Area& area) {
  const Area inside = draw_frame(screen, area, "path from above");
  if (inside.width < 6 || inside.height < 3) return;
  BrailleCanvas canvas(inside.width, inside.height);

  Extent forward{state.camera.x_m, state.camera.x_m};
  Extent left{state.camera.y_m, state.camera.y_m};
  for (const auto& pose : state.path) forward.hold(pose.x_m), left.hold(pose.y_m);
  const double aspect = static_cast<double>(canvas.width()) / canvas.height();
  const double span = map_span(std::max(forward.length(), left.length() / aspect) * 1.15 + 0.6);
  const double scale = canvas.height() / span;  // dots per metre
  const auto on_map = [&](double x, double y) {
    return Dot{canvas.width() / 2.0 - (y - left.middle()) * scale,
               canvas.height() / 2.0 - (x - forward.middle()) * scale};
  };

  double grid = 1;
  while (grid * scale < 7) grid *= grid < 4 ? 2 : 2.5;
  const double reach_x = span / 2;
  const double reach_y = reach_x * aspect;
  for (double x = std::ceil((forward.middle() - reach_x) / grid) * grid; x <= forward.middle() + reach_x; x += grid) {
    for (double y = std::ceil((left.middle() - reach_y) / grid) * grid; y <= left.middle() + reach_y; y += grid) {
      canvas.dot(on_map(x, y), palette::kFrame, 0);
    }
  }
  canvas.circle(on_map(0, 0), 2, palette::kDim, 1);
  for (std::size_t i = 0; i < state.path.size(); ++i) {
    const auto& to = i + 1 < state.path.size() ? state.path[i + 1] : state.camera;
    const double age = static_cast<double>(i + 1) / static_cast<double>(state.path.size());
    canvas.line(on_map(state.path[i].x_m, state.path[i].y_m), on_map(to.x_m, to.y_m),
                mixed(mixed(palette::kFaint, palette::kPath, 0.5), palette::kPath, age), 2);
  }
  // The camera: an arrow head, a fixed size in dots.
  const Dot at = on_map(state.camera.x_m, state.camera.y_m);
  const auto towards = [&](double angle, double dots) {
    const double heading = state.camera.heading_rad + angle;
    return Dot{at.x - dots * std::sin(heading), at.y - dots * std::cos(heading)};
  };
  const Dot tip = towards(0, 5);
  for (const double angle : {2.5, -2.5}) canvas.line(tip, towards(angle, 4.5), palette::kMiddle, 3, 1.5);
  canvas.line(towards(2.5, 4.5), towards(-2.5, 4.5), palette::kMiddle, 3);
  canvas.draw_on(screen, inside.column, inside.row);
  const std::string legend = formatted(" grid %g m ", grid);
  screen.put(area.column + area.width - 2 - static_cast<int>(legend.size()), area.row + area.height - 1, legend,
             {palette::kDim, false});
}

}  // namespace armature::tools
