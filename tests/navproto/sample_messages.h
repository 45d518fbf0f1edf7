#pragma once

#include <armature/navproto/control_messages.h>
#include <armature/navproto/feed_message.h>
#include <armature/navproto/messages.h>

// One message of each kind in which every field has a value of its own. The golden bytes of tests/data/navproto are
// these.

namespace armature::navproto::sample {

using std::chrono::nanoseconds;

inline Header header() {
  return {0x0123456789abcdef, 42, nanoseconds(5'000'000'004), true};
}

inline FrameTimes times() {
  return {1234, nanoseconds(5'000'000'001), SensorClock::Recording, nanoseconds(5'000'000'002),
          nanoseconds(5'000'000'003)};
}

inline NavigationMessage navigation() {
  NavigationMessage message{header(),
                            times(),
                            3,
                            Engagement::Engaged,
                            StopReason::None,
                            {0.75, -1.25},
                            0.5F,
                            -0.625F,
                            MotionId::Step,
                            MotionId::RotateBust,
                            {},
                            {}};
  for (std::size_t i = 0; i < kMotionCount; ++i) {
    const float value = static_cast<float>(i) / 16;
    message.motions[i] = {value * 2, value, -value, 1 - value};
  }
  for (std::size_t i = 0; i < kStageCount; ++i) message.stage_us[i] = static_cast<float>(100 * i + 1);
  return message;
}

inline SkeletonMessage skeleton() {
  SkeletonMessage message;
  message.header = header();
  message.times = times();
  message.user_id = 3;
  message.tracking = true;
  for (std::size_t i = 0; i < kJointCount; ++i) {
    const float value = static_cast<float>(i) / 32;
    message.joints[i] = {{value, -value, 2 + value}, value, static_cast<JointState>(i % 3)};
  }
  message.user_position = {0.25F, -0.5F, 2.5F};
  message.user_up = {0, -0.8F, -0.6F};
  message.user_left = {1, 0, 0};
  message.user_forward = {0, 0.6F, -0.8F};
  return message;
}

inline EventMessage event() {
  return {header(), EventKind::MotionTooNoisy, nanoseconds(4'999'999'999), 3,
          "lean_bust is too noisy at 3.9 m: \u03b1 > 0.45"};
}

inline HealthMessage health() {
  return {
      header(),   nanoseconds(4'999'999'998), 12.5, "0.1.0", "oni:person.oni", true, 300, 2, 298, 29.97F, 4200, 9100,
      120'000'000};
}

/// 8 x 6 pixels: a person of 1.5 m in front of a wall at 4 m.
inline FeedMessage feed() {
  FeedMessage message{header(), times(), {8, 6, 7.5, 7.25, 3.5, 2.5}, {}, {}};
  for (int v = 0; v < 6; ++v) {
    for (int u = 0; u < 8; ++u) {
      const bool person = u >= 3 && u <= 4;
      message.depth_mm.push_back(static_cast<std::uint16_t>(person ? 1500 + v : 4000 + u));
      message.user_mask.push_back(person ? 1 : 0);
    }
  }
  return message;
}

inline ControlSettings settings() {
  ControlSettings settings;
  settings.turn_motion = MotionId::RotateShoulders;
  settings.walk_motion = MotionId::BendBust;
  settings.max_walk_m_s = 1.5F;
  settings.max_turn_rad_s = 1.25F;
  settings.walk_acceleration_m_s2 = 2;
  settings.turn_acceleration_rad_s2 = 3;
  settings.motions = {{MotionId::RotateShoulders, 0.5F, 0.25F, 1.5F}, {MotionId::BendBust, std::nullopt, 0.0F, {}}};
  return settings;
}

inline ControlRequest request() {
  return {77, RequestKind::Set, settings()};
}

inline ControlReply reply() {
  HealthMessage state = health();
  state.header = {};
  return {77, "alpha: must be from 0 to below 1", Engagement::CapturingRest, 3, settings(), state};
}

}  // namespace armature::navproto::sample
