#include "tracker/daemon/wire.h"

#include <fmt/format.h>

#include "tracker/config.h"

namespace armature {
namespace {

namespace wire = navproto;

static_assert(wire::kMotionNames == kMotionNames, "the wire and the tracker number motions alike");
static_assert(wire::kJointNames == kJointNames, "the wire and the tracker number joints alike");
static_assert(wire::kStageNames == kStageNames, "the wire and the tracker number stages alike");
static_assert(static_cast<int>(wire::JointState::Observed) == static_cast<int>(JointState::Observed));
static_assert(static_cast<int>(wire::SensorClock::HostMonotonic) == static_cast<int>(ClockId::HostMonotonic));

wire::MotionId on_wire(MotionId motion) {
  return static_cast<wire::MotionId>(motion);
}
wire::Vec3 on_wire(const Eigen::Vector3f& v) {
  return {v.x(), v.y(), v.z()};
}

void fill_times(wire::FrameTimes& times, const TrackerOutput& output) noexcept {
  times.frame = output.sequence;
  times.sensor = output.sensor.time;
  times.sensor_clock = static_cast<wire::SensorClock>(output.sensor.clock);
  times.received = output.host.time;
}

}  // namespace

wire::Engagement wire_engagement(EngagementState state) noexcept {
  switch (state) {
    case EngagementState::Absent: return wire::Engagement::NoUser;
    case EngagementState::Waiting: return wire::Engagement::Detected;
    case EngagementState::Calibrating: return wire::Engagement::CapturingRest;
    case EngagementState::Engaged: return wire::Engagement::Engaged;
    case EngagementState::Lost: return wire::Engagement::Suspended;
  }
  return wire::Engagement::NoUser;
}

wire::StopReason wire_stop(StopReason reason) noexcept {
  switch (reason) {
    case StopReason::None: return wire::StopReason::None;
    case StopReason::NoUser: return wire::StopReason::NoUser;
    case StopReason::NotEngaged: return wire::StopReason::NotEngaged;
    case StopReason::TrackingLost: return wire::StopReason::TrackingLost;
    case StopReason::TooNoisy: return wire::StopReason::TooNoisy;
  }
  return wire::StopReason::NoUser;
}

void fill_message(wire::NavigationMessage& message, const TrackerOutput& output, const SteeringPair& pair) noexcept {
  fill_times(message.times, output);
  message.user_id = output.user;
  message.engagement = wire_engagement(output.state);
  message.stop_reason = wire_stop(output.stop);
  const Navigation& navigation = output.navigation;
  message.velocity = {navigation.velocity.linear_m_s, navigation.velocity.angular_rad_s};
  message.walk = navigation.walk;
  message.turn = navigation.turn;
  message.walk_motion = on_wire(pair.walk);
  message.turn_motion = on_wire(pair.turn);
  for (std::size_t m = 0; m < kMotionCount; ++m) {
    const MotionOutput& motion = navigation.motions[m];
    message.motions[m] = {motion.angle_rad, motion.normalized, motion.shaped, motion.confidence};
  }
  for (std::size_t stage = 0; stage < kStageCount; ++stage) {
    message.stage_us[stage] = std::chrono::duration<float, std::micro>(output.stage_time[stage]).count();
  }
}

void fill_message(wire::SkeletonMessage& message, const TrackerOutput& output) noexcept {
  fill_times(message.times, output);
  message.user_id = output.user;
  message.tracking = output.tracking;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    const Joint& joint = output.skeleton.joints[j];
    message.joints[j] = {on_wire(joint.position), joint.confidence, static_cast<wire::JointState>(joint.state)};
  }
  message.user_position = on_wire(output.skeleton.user_position);
  message.user_up = on_wire(output.user_frame.up);
  message.user_left = on_wire(output.user_frame.left);
  message.user_forward = on_wire(output.user_frame.forward);
}

void fill_stop(wire::NavigationMessage& message, wire::StopReason reason) noexcept {
  message.stop_reason = reason;
  message.velocity = {};
  message.walk = 0;
  message.turn = 0;
  message.motions = {};
  message.stage_us = {};
}

wire::EventMessage event_message(const TrackerEvent& event, const Navigation& navigation) {
  wire::EventMessage message;
  message.user_id = event.user;
  const auto say = [&](wire::EventKind kind, std::string text) {
    message.kind = kind;
    message.text = std::move(text);
    return message;
  };
  switch (event.kind) {
    case TrackerEventKind::UserEntered:
      return say(wire::EventKind::UserEntered, fmt::format("user {} is in front of the sensor", event.user));
    case TrackerEventKind::UserLeft: return say(wire::EventKind::UserLeft, fmt::format("user {} left", event.user));
    case TrackerEventKind::RestCaptured: return say(wire::EventKind::RestCaptured, "rest pose captured");
    case TrackerEventKind::Engaged: return say(wire::EventKind::Engaged, fmt::format("user {} steers", event.user));
    case TrackerEventKind::Released:
      return say(wire::EventKind::Disengaged, fmt::format("user {} steers no more; anybody may be next", event.user));
    case TrackerEventKind::TrackingLost:
      return say(wire::EventKind::TrackingLost, fmt::format("user {} cannot be tracked", event.user));
    case TrackerEventKind::TrackingRegained:
      return say(wire::EventKind::TrackingRecovered, fmt::format("user {} steers again", event.user));
    case TrackerEventKind::MotionTooNoisy:
      return say(wire::EventKind::MotionTooNoisy,
                 fmt::format("{} is too noisy here and now: it would need a dead zone of {:.2f} of its range (at most "
                             "{}); stand nearer, or still for a new rest pose",
                             kMotionNames[index(event.motion)], navigation.motions[index(event.motion)].dead_zone,
                             kMaxDeadZone));
  }
  return message;
}

wire::ControlSettings settings_of(const NavigationOptions& options) {
  wire::ControlSettings settings;
  settings.turn_motion = on_wire(options.pair.turn);
  settings.walk_motion = on_wire(options.pair.walk);
  settings.max_walk_m_s = options.actuator.max_walk_m_s;
  settings.max_turn_rad_s = options.actuator.max_turn_rad_s;
  settings.walk_acceleration_m_s2 = options.actuator.walk_acceleration_m_s2;
  settings.turn_acceleration_rad_s2 = options.actuator.turn_acceleration_rad_s2;
  for (std::size_t m = 0; m < kMotionCount; ++m) {
    settings.motions.push_back({.motion = static_cast<wire::MotionId>(m),
                                .range_rad = options.motions.range_rad[m],
                                .alpha = options.transfer[m].alpha,
                                .beta = options.transfer[m].beta});
  }
  return settings;
}

Expected<NavigationOptions> changed(const NavigationOptions& options, const wire::ControlSettings& settings) {
  NavigationOptions now = options;
  if (settings.turn_motion) now.pair.turn = static_cast<MotionId>(*settings.turn_motion);
  if (settings.walk_motion) now.pair.walk = static_cast<MotionId>(*settings.walk_motion);
  ActuatorOptions& actuator = now.actuator;
  actuator.max_walk_m_s = settings.max_walk_m_s.value_or(actuator.max_walk_m_s);
  actuator.max_turn_rad_s = settings.max_turn_rad_s.value_or(actuator.max_turn_rad_s);
  actuator.walk_acceleration_m_s2 = settings.walk_acceleration_m_s2.value_or(actuator.walk_acceleration_m_s2);
  actuator.turn_acceleration_rad_s2 = settings.turn_acceleration_rad_s2.value_or(actuator.turn_acceleration_rad_s2);
  for (const wire::MotionSetting& setting : settings.motions) {
    const auto m = static_cast<std::size_t>(setting.motion);
    now.motions.range_rad[m] = setting.range_rad.value_or(now.motions.range_rad[m]);
    now.transfer[m].alpha = setting.alpha.value_or(now.transfer[m].alpha);
    now.transfer[m].beta = setting.beta.value_or(now.transfer[m].beta);
  }
  // The configuration's own bounds, by its own reader: what cannot be saved cannot be set.
  Config probe;
  probe.tracker.navigation = now;
  if (const auto checked = parse_config(print_config(probe), "settings"); !checked) {
    return tl::unexpected(checked.error());
  }
  return now;
}

}  // namespace armature
