#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <string>

#include <armature/navproto/header.h>
#include <armature/navproto/vocabulary.h>

// What a publisher says, as plain values. Units, frames and signs are those of schema/armature.fbs: metres, radians,
// seconds; camera frame x right, y down, z forward; walk positive = forward, turn positive = to the left.

namespace armature::navproto {

struct Vec3 {
  float x = 0, y = 0, z = 0;

  friend bool operator==(const Vec3&, const Vec3&) = default;
};

/// The two speeds that section 3.4.3 hands to Move() and Rotate().
struct Velocity {
  double linear_m_s = 0;     ///< along the view, positive = forward
  double angular_rad_s = 0;  ///< about up, positive = to the left

  friend bool operator==(const Velocity&, const Velocity&) = default;
};

struct MotionValue {
  float angle_rad = 0;   ///< against the rest pose
  float normalised = 0;  ///< [-1, 1], angle over range
  float shaped = 0;      ///< [-1, 1], after the transfer function
  float confidence = 0;  ///< [0, 1]

  friend bool operator==(const MotionValue&, const MotionValue&) = default;
};

struct JointValue {
  Vec3 position{};       ///< camera frame, metres
  float confidence = 0;  ///< [0, 1]
  JointState state = JointState::Lost;

  friend bool operator==(const JointValue&, const JointValue&) = default;
};

struct NavigationMessage {
  Header header{};
  FrameTimes times{};
  std::uint32_t user_id = 0;  ///< 0 = nobody
  Engagement engagement = Engagement::NoUser;
  StopReason stop_reason = StopReason::None;
  Velocity velocity{};
  float walk = 0;  ///< [-1, 1], what the linear velocity is driven by
  float turn = 0;  ///< [-1, 1], what the angular velocity is driven by
  MotionId walk_motion = MotionId::BendKnees;
  MotionId turn_motion = MotionId::LeanBust;
  std::array<MotionValue, kMotionCount> motions{};  ///< by MotionId
  std::array<float, kStageCount> stage_us{};        ///< by Stage, microseconds

  friend bool operator==(const NavigationMessage&, const NavigationMessage&) = default;
};

struct SkeletonMessage {
  Header header{};
  FrameTimes times{};
  std::uint32_t user_id = 0;
  bool tracking = false;                         ///< a skeleton is there; if not, the joints are the last known ones
  std::array<JointValue, kJointCount> joints{};  ///< by JointId
  Vec3 user_position{};                          ///< centre of mass of the torso's visible pixels, camera frame
  Vec3 user_up{0, -1, 0};  ///< the frame in which motions are measured, unit vectors in the camera frame
  Vec3 user_left{1, 0, 0};
  Vec3 user_forward{0, 0, -1};

  friend bool operator==(const SkeletonMessage&, const SkeletonMessage&) = default;
};

struct EventMessage {
  Header header{};
  EventKind kind = EventKind::Warning;
  std::chrono::nanoseconds time{0};  ///< by the publisher's monotonic clock
  std::uint32_t user_id = 0;         ///< 0 = about nobody
  std::string text{};                ///< one line for a human being, at most 1024 bytes

  friend bool operator==(const EventMessage&, const EventMessage&) = default;
};

struct HealthMessage {
  Header header{};
  std::chrono::nanoseconds time{0};  ///< by the publisher's monotonic clock
  double uptime_s = 0;
  std::string version{};
  std::string source{};  ///< its URI
  bool source_alive = false;
  std::uint64_t frames_received = 0;
  std::uint64_t frames_dropped = 0;  ///< replaced by a newer one before the tracker took them
  std::uint64_t frames_processed = 0;
  float frames_per_second = 0;
  float latency_p50_us = 0;  ///< frame received to message handed to the socket, over the last seconds
  float latency_p99_us = 0;
  std::uint64_t resident_bytes = 0;

  friend bool operator==(const HealthMessage&, const HealthMessage&) = default;
};

}  // namespace armature::navproto
