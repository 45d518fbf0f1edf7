// Walking: who is listened to, how motions become speeds, where the camera stands.
#include <array>
#include <numbers>
#include <string>

#include "viewer/session/command.h"
#include "viewer/session/session.h"

namespace armature::viewer {
namespace {

using Done = sdk::Expected<void>;

constexpr double kDegrees = 180 / std::numbers::pi;

const std::vector<std::string_view> kMotions = {navproto::kMotionNames.begin(), navproto::kMotionNames.end()};

Done connect(Session& session, Arguments& arguments) {
  const std::string endpoint = arguments.word("endpoint");
  const std::string file = arguments.left() > 0 ? arguments.word("keys") : "";
  const std::string server = file.empty() ? "" : arguments.word("the daemon's public key");
  if (auto checked = arguments.check(); !checked) return checked;
  std::optional<navproto::CurveClient> curve;
  if (!file.empty()) {
    auto keys = navproto::read_key_pair(file);
    if (!keys) return sdk::fail(keys.error().message);
    if (!navproto::is_key(server))
      return sdk::fail("expected the daemon's public key, 40 characters as `armature keys new` printed them there");
    curve = navproto::CurveClient{server, std::move(*keys)};
  }
  if (auto connected = session.walk.connect(endpoint, std::move(curve)); !connected) return connected;
  session.mode = Mode::Walk;
  return {};
}

Done person(Session& session, Arguments& arguments) {
  const std::string source = arguments.left() > 0 ? arguments.word("source") : "synth:demo";
  if (auto checked = arguments.check(); !checked) return checked;
  if (auto started = session.walk.start_daemon(source); !started) return started;
  session.mode = Mode::Walk;
  return {};
}

Done disconnect(Session& session, Arguments& arguments) {
  if (auto checked = arguments.check(); !checked) return checked;
  session.walk.disconnect();
  return {};
}

Done place(Session& session, Arguments& arguments) {
  navproto::CameraPose pose;
  pose.x_m = arguments.number("x", -1e6, 1e6);
  pose.y_m = arguments.number("y", -1e6, 1e6);
  pose.heading_rad = arguments.number("heading in degrees", -1e6, 1e6) / kDegrees;
  if (auto checked = arguments.check(); !checked) return checked;
  session.walk.place(pose);
  return {};
}

Done path(Session& session, Arguments& arguments) {
  const bool start = arguments.choice("path", {"stop", "start"}) == 1;
  if (auto checked = arguments.check(); !checked) return checked;
  session.mode = Mode::Walk;
  if (start) {
    session.walk.start_path();
  } else {
    session.walk.stop_path();
  }
  return {};
}

Done set(Session& session, navproto::ControlSettings settings) {
  return session.walk.request({.kind = navproto::RequestKind::Set, .settings = std::move(settings)});
}

Done pair(Session& session, Arguments& arguments) {
  navproto::ControlSettings settings;
  settings.turn_motion = static_cast<navproto::MotionId>(arguments.choice("motion that turns", kMotions));
  settings.walk_motion = static_cast<navproto::MotionId>(arguments.choice("motion that walks", kMotions));
  if (auto checked = arguments.check(); !checked) return checked;
  return set(session, std::move(settings));
}

Done motion(Session& session, Arguments& arguments) {
  navproto::MotionSetting setting;
  setting.motion = static_cast<navproto::MotionId>(arguments.choice("motion", kMotions));
  setting.range_rad = static_cast<float>(arguments.number("range in degrees", 1, 120) / kDegrees);
  setting.alpha = static_cast<float>(arguments.number("alpha", 0, 0.9));
  setting.beta = static_cast<float>(arguments.number("beta", 0.2, 5));
  if (auto checked = arguments.check(); !checked) return checked;
  navproto::ControlSettings settings;
  settings.motions.push_back(setting);
  return set(session, std::move(settings));
}

Done speeds(Session& session, Arguments& arguments) {
  navproto::ControlSettings settings;
  settings.max_walk_m_s = static_cast<float>(arguments.number("metres a second", 0.01, 100));
  settings.max_turn_rad_s = static_cast<float>(arguments.number("degrees a second", 0.1, 720) / kDegrees);
  if (auto checked = arguments.check(); !checked) return checked;
  return set(session, std::move(settings));
}

template <navproto::RequestKind Kind>
Done ask(Session& session, Arguments& arguments) {
  if (auto checked = arguments.check(); !checked) return checked;
  return session.walk.request({.kind = Kind});
}

constexpr std::array kCommands = {
    Command{"connect", "ENDPOINT [KEYS SERVER]",
            "walk by what a daemon publishes there; over tcp with our key file and its public key", connect, true},
    Command{"person", "[SOURCE]", "start a daemon on a synthetic person (synth:NAME) or a recording (oni:FILE)", person,
            true},
    Command{"disconnect", "", "listen to nobody", disconnect, true},
    Command{"place", "X Y HEADING", "stand there: metres, degrees to the left", place, true},
    Command{"path", "start|stop", "follow the path through the city, from its start", path, true},
    Command{"pair", "TURN WALK", "the motions that turn and walk", pair, true},
    Command{"motion", "NAME RANGE ALPHA BETA", "its range in degrees, dead zone and slope", motion, true},
    Command{"speeds", "WALK TURN", "the largest: metres and degrees a second", speeds, true},
    Command{"rerest", "", "take the rest pose again", ask<navproto::RequestKind::Rerest>, true},
    Command{"save-settings", "", "write the daemon's settings to its file", ask<navproto::RequestKind::Save>, true},
    Command{"reload-settings", "", "read that file again", ask<navproto::RequestKind::Reload>, true},
};

}  // namespace

std::span<const Command> walk_commands() {
  return kCommands;
}

}  // namespace armature::viewer
