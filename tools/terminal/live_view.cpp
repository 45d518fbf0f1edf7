#include "tools/terminal/live_view.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <numbers>

#include "tools/terminal/panels.h"

namespace armature::tools {
namespace {

using navproto::Engagement;
using navproto::StopReason;

template <class... Args>
std::string formatted(const char* format, Args... args) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), format, args...);
  return text.data();
}

std::string words(std::string_view name) {
  std::string text(name);
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

/// Whether the velocities are zero for a reason that the state of engagement does not already tell.
bool stopped(const navproto::NavigationMessage& navigation) {
  return navigation.stop_reason != StopReason::None && navigation.stop_reason != StopReason::NoUser &&
         navigation.stop_reason != StopReason::NotEngaged;
}

Rgb status_colour(const LiveState& state) {
  if (!state.fresh || !state.navigation) return palette::kDim;
  if (stopped(*state.navigation)) return palette::kWarning;
  switch (state.navigation->engagement) {
    case Engagement::Engaged: return palette::kWalk;
    case Engagement::CapturingRest:
    case Engagement::Detected: return palette::kWaiting;
    case Engagement::Suspended: return palette::kWarning;
    case Engagement::NoUser: return palette::kDim;
  }
  return palette::kDim;
}

void draw_header(const LiveState& state, Screen& screen) {
  int column = screen.put(1, 0, "armature", {palette::kMiddle, true});
  const Rgb colour = status_colour(state);
  column = screen.put(column + 2, 0, state.fresh ? "● " : "○ ", {colour, true});
  column = screen.put(column, 0, status_text(state), {colour, true});
  if (state.navigation && state.navigation->user_id != 0) {
    column = screen.put(column, 0, formatted("  user %u", state.navigation->user_id), {palette::kText, false});
  }
  std::string right =
      formatted("%d:%02d", static_cast<int>(state.elapsed.count()) / 60, static_cast<int>(state.elapsed.count()) % 60);
  if (state.fresh) {
    right = formatted("%2.0f Hz  %4.1f ms  ", state.frames_per_second, state.latency.count() * 1e3) + right;
  }
  screen.put(std::max(column + 1, screen.width() - 1 - static_cast<int>(right.size())), 0, right,
             {palette::kDim, false});
}

void draw_footer(const LiveState& state, Screen& screen) {
  const int row = screen.height() - 1;
  constexpr std::string_view kHint = "q quits";
  std::string left = state.endpoint;
  if (state.health) {
    const std::string& source = state.health->source;
    left = source.substr(source.find_last_of('/') + 1);
    if (state.health->frames_dropped > 0) {
      left += formatted("  %llu dropped", static_cast<unsigned long long>(state.health->frames_dropped));
    }
  }
  if (!state.event.empty()) left += "  ·  " + state.event;
  screen.put(1, row, left, {palette::kDim, false}, screen.width() - 4 - static_cast<int>(kHint.size()));
  screen.put(screen.width() - 1 - static_cast<int>(kHint.size()), row, kHint, {palette::kFrame, false});
}

}  // namespace

std::string status_text(const LiveState& state) {
  if (!state.navigation) return "waiting for " + state.endpoint;
  const auto& navigation = *state.navigation;
  if (stopped(navigation)) return "stopped: " + words(navproto::name(navigation.stop_reason));
  if (!state.fresh) return "silent: nothing has come for a while";
  switch (navigation.engagement) {
    case Engagement::NoUser: return "nobody there";
    case Engagement::Detected: return "somebody there, not steering";
    case Engagement::CapturingRest: return "stand still: taking the rest pose";
    case Engagement::Engaged: return "steering";
    case Engagement::Suspended: return "suspended: tracking lost";
  }
  return {};
}

void draw_live_view(const LiveState& state, Screen& screen) {
  draw_header(state, screen);
  draw_footer(state, screen);
  const int height = screen.height() - 2;
  if (height < 3) return;
  const int body_width = std::clamp(screen.width() * 46 / 100, 24, std::max(24, height * 2));
  const int right = screen.width() - body_width;
  const int motions_height = height >= 36 ? 19 : std::min(height, 10);
  const int lower = height - motions_height;
  const int speeds_width = std::clamp(right * 2 / 5, 20, 30);
  draw_body(state, screen, {0, 1, body_width, height});
  draw_motions(state, screen, {body_width, 1, right, motions_height});
  if (lower < 4) return;
  draw_velocities(state, screen, {body_width, 1 + motions_height, speeds_width, lower});
  draw_path(state, screen, {body_width + speeds_width, 1 + motions_height, right - speeds_width, lower});
}

std::string live_line(const LiveState& state) {
  std::string line = formatted("%7.1f s  ", state.elapsed.count());
  if (!state.navigation) return line + status_text(state);
  const auto& navigation = *state.navigation;
  const auto motion = [&](navproto::MotionId id) {
    return formatted("%s %+.2f", words(navproto::name(id)).c_str(),
                     navigation.motions[static_cast<std::size_t>(id)].normalised);
  };
  line += formatted("frame %5llu  ", static_cast<unsigned long long>(navigation.times.frame));
  line += formatted("walk %+.2f m/s (%s)  turn %+4.0f deg/s (%s)  ", state.velocity.linear_m_s,
                    motion(navigation.walk_motion).c_str(), state.velocity.angular_rad_s * 180 / std::numbers::pi,
                    motion(navigation.turn_motion).c_str());
  line += formatted("camera %+.2f %+.2f m %+4.0f deg  ", state.camera.x_m, state.camera.y_m,
                    state.camera.heading_rad * 180 / std::numbers::pi);
  return line + formatted("%.1f ms  ", state.latency.count() * 1e3) + status_text(state);
}

}  // namespace armature::tools
