#include <cmath>
#include <numbers>

#include "navproto/src/wire.h"

namespace armature::navproto {
namespace {

using Complaint = std::optional<Error>;

Complaint complain(std::string_view place, std::string_view expected) {
  return Error{std::string(place) + ": " + std::string(expected)};
}

/// Collects the first complaint, so that the checks of a message read as a list.
class Checks {
 public:
  Checks& finite(std::string_view place, double value) {
    return require(std::isfinite(value), place, "must be finite");
  }
  Checks& within(std::string_view place, double value, double low, double high, std::string_view expected) {
    return require(value >= low && value <= high, place, expected);  // false for NaN, too
  }
  Checks& ratio(std::string_view place, double value) { return within(place, value, -1, 1, "must be from -1 to 1"); }
  Checks& confidence(std::string_view place, double value) { return within(place, value, 0, 1, "must be from 0 to 1"); }
  Checks& not_negative(std::string_view place, double value) {
    return require(std::isfinite(value) && value >= 0, place, "must be finite and not negative");
  }
  Checks& time(std::string_view place, std::chrono::nanoseconds value) {
    return require(value.count() >= 0, place, "must not be negative");
  }
  Checks& point(std::string_view place, const Vec3& v) {
    return finite(place, v.x).finite(place, v.y).finite(place, v.z);
  }
  template <class Enum, std::size_t N>
  Checks& known(std::string_view place, Enum value, const std::array<std::string_view, N>&) {
    return require(static_cast<std::size_t>(value) < N, place, "unknown value");
  }
  Checks& text(std::string_view place, std::string_view value) {
    return require(is_text(value), place, "must be one line of UTF-8 of at most 1024 bytes");
  }
  Checks& require(bool holds, std::string_view place, std::string_view expected) {
    if (!holds && !complaint_) complaint_ = complain(place, expected);
    return *this;
  }
  Complaint take() { return std::move(complaint_); }

 private:
  Complaint complaint_;
};

void check_header(Checks& checks, const Header& header) {
  checks.time("header.sent", header.sent);
}

void check_times(Checks& checks, const FrameTimes& times) {
  checks.time("times.sensor", times.sensor)
      .time("times.received", times.received)
      .time("times.published", times.published)
      .known("times.sensor_clock", times.sensor_clock, kSensorClockNames);
}

void check_health(Checks& checks, const HealthMessage& message) {
  checks.time("health.time", message.time)
      .not_negative("health.uptime", message.uptime_s)
      .text("health.version", message.version)
      .text("health.source", message.source)
      .text("health.source_trouble", message.source_trouble)
      .not_negative("health.frames_per_second", message.frames_per_second)
      .not_negative("health.latency_p50", message.latency_p50_us)
      .not_negative("health.latency_p99", message.latency_p99_us);
}

void check_settings(Checks& checks, const ControlSettings& settings) {
  const auto motion = [&](std::string_view place, const std::optional<MotionId>& value) {
    if (value) checks.known(place, *value, kMotionNames);
  };
  const auto positive = [&](std::string_view place, const std::optional<float>& value, double high,
                            std::string_view expected) {
    if (value) checks.require(*value > 0 && *value <= high, place, expected);
  };
  motion("settings.turn_motion", settings.turn_motion);
  motion("settings.walk_motion", settings.walk_motion);
  positive("settings.max_walk_m_s", settings.max_walk_m_s, 100, "must be above 0 and at most 100");
  positive("settings.max_turn_rad_s", settings.max_turn_rad_s, 100, "must be above 0 and at most 100");
  positive("settings.walk_acceleration_m_s2", settings.walk_acceleration_m_s2, 100, "must be above 0 and at most 100");
  positive("settings.turn_acceleration_rad_s2", settings.turn_acceleration_rad_s2, 100,
           "must be above 0 and at most 100");
  checks.require(settings.motions.size() <= kMotionCount, "settings.motions", "at most one for each motion");
  std::array<bool, kMotionCount> seen{};
  for (const MotionSetting& setting : settings.motions) {
    const auto i = static_cast<std::size_t>(setting.motion);
    checks.require(i < kMotionCount && !seen[i], "settings.motions", "each a known motion, at most once");
    if (i < kMotionCount) seen[i] = true;
    positive("settings.motions.range_rad", setting.range_rad, std::numbers::pi_v<float>,
             "must be above 0 and at most pi");
    if (setting.alpha) {
      checks.require(*setting.alpha >= 0 && *setting.alpha < 1, "settings.motions.alpha", "must be from 0 to below 1");
    }
    positive("settings.motions.beta", setting.beta, 16, "must be above 0 and at most 16");
  }
}

}  // namespace

Complaint check(const NavigationMessage& message) {
  Checks checks;
  check_header(checks, message.header);
  check_times(checks, message.times);
  checks.known("engagement", message.engagement, kEngagementNames)
      .known("stop_reason", message.stop_reason, kStopReasonNames)
      .finite("linear velocity", message.velocity.linear_m_s)
      .finite("angular velocity", message.velocity.angular_rad_s)
      .ratio("walk", message.walk)
      .ratio("turn", message.turn)
      .known("walk_motion", message.walk_motion, kMotionNames)
      .known("turn_motion", message.turn_motion, kMotionNames)
      .require(message.stop_reason == StopReason::None || message.velocity == Velocity{}, "velocity",
               "must be zero with a stop reason");
  for (const MotionValue& motion : message.motions) {
    checks.finite("motions.angle", motion.angle_rad)
        .ratio("motions.normalised", motion.normalised)
        .ratio("motions.shaped", motion.shaped)
        .confidence("motions.confidence", motion.confidence);
  }
  for (const float microseconds : message.stage_us) checks.not_negative("stage_us", microseconds);
  return checks.take();
}

Complaint check(const SkeletonMessage& message) {
  Checks checks;
  check_header(checks, message.header);
  check_times(checks, message.times);
  for (const JointValue& joint : message.joints) {
    checks.point("joints.position", joint.position)
        .confidence("joints.confidence", joint.confidence)
        .known("joints.state", joint.state, kJointStateNames);
  }
  checks.point("user_position", message.user_position)
      .point("user_up", message.user_up)
      .point("user_left", message.user_left)
      .point("user_forward", message.user_forward);
  return checks.take();
}

Complaint check(const EventMessage& message) {
  Checks checks;
  check_header(checks, message.header);
  checks.known("kind", message.kind, kEventKindNames).time("time", message.time).text("text", message.text);
  return checks.take();
}

Complaint check(const HealthMessage& message) {
  Checks checks;
  check_header(checks, message.header);
  check_health(checks, message);
  return checks.take();
}

Complaint check(const FeedView& view) {
  Checks checks;
  check_header(checks, view.header);
  check_times(checks, view.times);
  const FeedIntrinsics& intrinsics = view.intrinsics;
  checks.within("width", intrinsics.width, 1, kMaxFeedSide, "must be from 1 to 4096")
      .within("height", intrinsics.height, 1, kMaxFeedSide, "must be from 1 to 4096")
      .finite("centre_x", intrinsics.centre_x_px)
      .finite("centre_y", intrinsics.centre_y_px)
      .require(std::isfinite(intrinsics.focal_x_px) && intrinsics.focal_x_px > 0, "focal_x", "must be positive")
      .require(std::isfinite(intrinsics.focal_y_px) && intrinsics.focal_y_px > 0, "focal_y", "must be positive");
  if (auto complaint = checks.take()) return complaint;
  const auto count = static_cast<std::size_t>(intrinsics.width) * static_cast<std::size_t>(intrinsics.height);
  checks.require(view.depth_mm.size() == count, "depth", "must hold width times height pixels")
      .require(view.user_mask.size() == count, "user mask", "must hold width times height pixels");
  return checks.take();
}

Complaint check(const ControlRequest& message) {
  Checks checks;
  checks.known("kind", message.kind, kRequestKindNames);
  check_settings(checks, message.settings);
  return checks.take();
}

Complaint check(const ControlReply& message) {
  Checks checks;
  checks.text("error", message.error).known("engagement", message.engagement, kEngagementNames);
  check_settings(checks, message.settings);
  check_health(checks, message.health);
  return checks.take();
}

}  // namespace armature::navproto
