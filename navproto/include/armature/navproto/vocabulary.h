#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

// The enumerations of schema/armature.fbs, in its order, and how each is spelled in text.

namespace armature::navproto {

// Every list keeps the rows of the schema.
// clang-format off

/// Messages of another version are refused.
inline constexpr std::uint8_t kSchemaVersion = 1;

enum class MotionId : std::uint8_t {
  RotateShoulders, RotateHips, RotateBust, LeanBust, BendBust, TranslateHips, BendKnees, Step,
};
inline constexpr std::size_t kMotionCount = 8;
inline constexpr std::array<std::string_view, kMotionCount> kMotionNames = {
    "rotate_shoulders", "rotate_hips", "rotate_bust", "lean_bust", "bend_bust", "translate_hips", "bend_knees", "step",
};

/// Left is the person's own.
enum class JointId : std::uint8_t {
  HeadTop, Head, Neck, Chest, Torso, Waist,
  LeftCollar, LeftShoulder, LeftUpperArm, LeftElbow, LeftForearm, LeftWrist, LeftHand,
  LeftHip, LeftThigh, LeftKnee, LeftAnkle, LeftFoot,
  RightCollar, RightShoulder, RightUpperArm, RightElbow, RightForearm, RightWrist, RightHand,
  RightHip, RightThigh, RightKnee, RightAnkle, RightFoot,
};
inline constexpr std::size_t kJointCount = 30;
inline constexpr std::array<std::string_view, kJointCount> kJointNames = {
    "head_top", "head", "neck", "chest", "torso", "waist",
    "left_collar", "left_shoulder", "left_upper_arm", "left_elbow", "left_forearm", "left_wrist", "left_hand",
    "left_hip", "left_thigh", "left_knee", "left_ankle", "left_foot",
    "right_collar", "right_shoulder", "right_upper_arm", "right_elbow", "right_forearm", "right_wrist", "right_hand",
    "right_hip", "right_thigh", "right_knee", "right_ankle", "right_foot",
};

enum class JointState : std::uint8_t { Lost, Inferred, Observed };
inline constexpr std::array<std::string_view, 3> kJointStateNames = {"lost", "inferred", "observed"};

/// Whose clock a sensor time was read from. Times of different clocks are not comparable.
enum class SensorClock : std::uint8_t { Device, Recording, Synthetic, HostMonotonic };
inline constexpr std::array<std::string_view, 4> kSensorClockNames = {
    "device", "recording", "synthetic", "host_monotonic"};

enum class Engagement : std::uint8_t {
  NoUser,         ///< nobody in front of the sensor
  Detected,       ///< somebody is there and does not steer
  CapturingRest,  ///< stands still while the rest pose is taken
  Engaged,        ///< steers
  Suspended,      ///< steered until tracking was lost; may go on
};
inline constexpr std::array<std::string_view, 5> kEngagementNames = {
    "no_user", "detected", "capturing_rest", "engaged", "suspended"};

/// Why both velocities are zero, whatever the body does. None: they follow the body (and may be zero all the same).
enum class StopReason : std::uint8_t {
  None, NoUser, NotEngaged, TrackingLost, RestRequested, EndOfStream, SourceFailed, Reload, Exit,
  TooNoisy,  ///< a steering motion would need too wide a dead zone to be steered with
};
inline constexpr std::array<std::string_view, 10> kStopReasonNames = {
    "none", "no_user", "not_engaged", "tracking_lost", "rest_requested", "end_of_stream", "source_failed", "reload",
    "exit", "too_noisy"};

/// The stages of the tracker, in the order in which a frame walks through them.
enum class Stage : std::uint8_t { Segmentation, Forest, Joints, Motions, Transfer, Engagement };
inline constexpr std::size_t kStageCount = 6;
inline constexpr std::array<std::string_view, kStageCount> kStageNames = {
    "segmentation", "forest", "joints", "motions", "transfer", "engagement"};

enum class EventKind : std::uint8_t {
  Started, Stopping, UserEntered, UserLeft, RestCaptured, Engaged, Disengaged, TrackingLost, TrackingRecovered,
  MotionTooNoisy, SourceLost, SourceRecovered, ConfigReloaded, ConfigRejected, ConfigSaved, Warning,
};
inline constexpr std::array<std::string_view, 16> kEventKindNames = {
    "started", "stopping", "user_entered", "user_left", "rest_captured", "engaged", "disengaged", "tracking_lost",
    "tracking_recovered", "motion_too_noisy", "source_lost", "source_recovered", "config_reloaded", "config_rejected",
    "config_saved", "warning"};

enum class RequestKind : std::uint8_t { Status, Rerest, Set, Save, Reload };
inline constexpr std::array<std::string_view, 5> kRequestKindNames = {"status", "rerest", "set", "save", "reload"};
// clang-format on

[[nodiscard]] constexpr std::string_view name(MotionId v) noexcept {
  return kMotionNames[static_cast<std::size_t>(v)];
}
[[nodiscard]] constexpr std::string_view name(JointId v) noexcept {
  return kJointNames[static_cast<std::size_t>(v)];
}
[[nodiscard]] constexpr std::string_view name(JointState v) noexcept {
  return kJointStateNames[static_cast<std::size_t>(v)];
}
[[nodiscard]] constexpr std::string_view name(SensorClock v) noexcept {
  return kSensorClockNames[static_cast<std::size_t>(v)];
}
[[nodiscard]] constexpr std::string_view name(Engagement v) noexcept {
  return kEngagementNames[static_cast<std::size_t>(v)];
}
[[nodiscard]] constexpr std::string_view name(StopReason v) noexcept {
  return kStopReasonNames[static_cast<std::size_t>(v)];
}
[[nodiscard]] constexpr std::string_view name(Stage v) noexcept {
  return kStageNames[static_cast<std::size_t>(v)];
}
[[nodiscard]] constexpr std::string_view name(EventKind v) noexcept {
  return kEventKindNames[static_cast<std::size_t>(v)];
}
[[nodiscard]] constexpr std::string_view name(RequestKind v) noexcept {
  return kRequestKindNames[static_cast<std::size_t>(v)];
}

}  // namespace armature::navproto
