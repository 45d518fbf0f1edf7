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

/// A point or a direction in the camera frame.
struct Vec3 {
  float x = 0;  ///< right
  float y = 0;  ///< down
  float z = 0;  ///< forward

  friend bool operator==(const Vec3&, const Vec3&) = default;
};

/// The two speeds that section 3.4.3 hands to Move() and Rotate().
struct Velocity {
  double linear_m_s = 0;     ///< along the view, positive = forward
  double angular_rad_s = 0;  ///< about up, positive = to the left

  friend bool operator==(const Velocity&, const Velocity&) = default;
};

/// How far one motion is carried out.
struct MotionValue {
  float angle_rad = 0;   ///< against the rest pose
  float normalised = 0;  ///< [-1, 1], angle over range
  float shaped = 0;      ///< [-1, 1], after the transfer function
  float confidence = 0;  ///< [0, 1]

  friend bool operator==(const MotionValue&, const MotionValue&) = default;
};

/// Where one joint is.
struct JointValue {
  Vec3 position{};                      ///< camera frame, metres
  float confidence = 0;                 ///< [0, 1]
  JointState state = JointState::Lost;  ///< whether it was seen

  friend bool operator==(const JointValue&, const JointValue&) = default;
};

/// Where the body steers to, once a frame.
struct NavigationMessage {
  Header header{};                                  ///< filled in by the publisher
  FrameTimes times{};                               ///< of the frame behind it
  std::uint32_t user_id = 0;                        ///< 0 = nobody
  Engagement engagement = Engagement::NoUser;       ///< of that person
  StopReason stop_reason = StopReason::None;        ///< why the velocity is zero, if it has to be
  Velocity velocity{};                              ///< what to hand to a camera
  float walk = 0;                                   ///< [-1, 1], what the linear velocity is driven by
  float turn = 0;                                   ///< [-1, 1], what the angular velocity is driven by
  MotionId walk_motion = MotionId::BendKnees;       ///< which motion drives `walk`
  MotionId turn_motion = MotionId::LeanBust;        ///< which motion drives `turn`
  std::array<MotionValue, kMotionCount> motions{};  ///< by MotionId
  std::array<float, kStageCount> stage_us{};        ///< by Stage, microseconds

  friend bool operator==(const NavigationMessage&, const NavigationMessage&) = default;
};

/// Where the joints are, once a frame.
struct SkeletonMessage {
  Header header{};                               ///< filled in by the publisher
  FrameTimes times{};                            ///< of the frame behind it
  std::uint32_t user_id = 0;                     ///< 0 = nobody
  bool tracking = false;                         ///< a skeleton is there; if not, the joints are the last known ones
  std::array<JointValue, kJointCount> joints{};  ///< by JointId
  Vec3 user_position{};                          ///< centre of mass of the torso's visible pixels, camera frame
  /// The frame in which motions are measured: unit vectors in the camera frame.
  Vec3 user_up{0, -1, 0};
  Vec3 user_left{1, 0, 0};      ///< the person's own left, as user_up
  Vec3 user_forward{0, 0, -1};  ///< where the person faces, as user_up

  friend bool operator==(const SkeletonMessage&, const SkeletonMessage&) = default;
};

/// Something that happened once.
struct EventMessage {
  Header header{};                      ///< filled in by the publisher
  EventKind kind = EventKind::Warning;  ///< what happened
  std::chrono::nanoseconds time{0};     ///< by the publisher's monotonic clock
  std::uint32_t user_id = 0;            ///< 0 = about nobody
  std::string text{};                   ///< one line for a human being, at most 1024 bytes

  friend bool operator==(const EventMessage&, const EventMessage&) = default;
};

/// How the daemon fares, once a second.
struct HealthMessage {
  Header header{};                     ///< filled in by the publisher
  std::chrono::nanoseconds time{0};    ///< by the publisher's monotonic clock
  double uptime_s = 0;                 ///< since the publisher started
  std::string version{};               ///< of the daemon
  std::string source{};                ///< its URI
  bool source_alive = false;           ///< whether good frames come
  std::uint64_t frames_received = 0;   ///< from the source, since the start
  std::uint64_t frames_dropped = 0;    ///< replaced by a newer one before the tracker took them
  std::uint64_t frames_processed = 0;  ///< by the tracker, since the start
  float frames_per_second = 0;         ///< processed, over the last seconds
  float latency_p50_us = 0;            ///< frame received to message handed to the socket, over the last seconds
  float latency_p99_us = 0;            ///< the same, exceeded by one message in a hundred
  std::uint64_t resident_bytes = 0;    ///< memory that the daemon holds
  std::string source_trouble{};  ///< one line: why no good frames come or what is wrong with what they show; or empty

  friend bool operator==(const HealthMessage&, const HealthMessage&) = default;
};

}  // namespace armature::navproto
