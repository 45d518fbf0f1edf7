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

/// The motions of the body that may steer (section 3.3).
enum class MotionId : std::uint8_t {
  RotateShoulders, RotateHips, RotateBust, LeanBust, BendBust, TranslateHips, BendKnees, Step,
};
/// How many there are.
inline constexpr std::size_t kMotionCount = 8;
/// By MotionId.
inline constexpr std::array<std::string_view, kMotionCount> kMotionNames = {
    "rotate_shoulders", "rotate_hips", "rotate_bust", "lean_bust", "bend_bust", "translate_hips", "bend_knees", "step",
};

/// The joints of the body. Left is the person's own.
enum class JointId : std::uint8_t {
  HeadTop, Head, Neck, Chest, Torso, Waist,
  LeftCollar, LeftShoulder, LeftUpperArm, LeftElbow, LeftForearm, LeftWrist, LeftHand,
  LeftHip, LeftThigh, LeftKnee, LeftAnkle, LeftFoot,
  RightCollar, RightShoulder, RightUpperArm, RightElbow, RightForearm, RightWrist, RightHand,
  RightHip, RightThigh, RightKnee, RightAnkle, RightFoot,
};
/// How many there are.
inline constexpr std::size_t kJointCount = 30;
/// By JointId.
inline constexpr std::array<std::string_view, kJointCount> kJointNames = {
    "head_top", "head", "neck", "chest", "torso", "waist",
    "left_collar", "left_shoulder", "left_upper_arm", "left_elbow", "left_forearm", "left_wrist", "left_hand",
    "left_hip", "left_thigh", "left_knee", "left_ankle", "left_foot",
    "right_collar", "right_shoulder", "right_upper_arm", "right_elbow", "right_forearm", "right_wrist", "right_hand",
    "right_hip", "right_thigh", "right_knee", "right_ankle", "right_foot",
};

/// Where a joint's position comes from.
enum class JointState : std::uint8_t {
  Lost,      ///< nowhere: it is the last one known
  Inferred,  ///< from other joints
  Observed,  ///< from pixels
};
/// By JointState.
inline constexpr std::array<std::string_view, 3> kJointStateNames = {"lost", "inferred", "observed"};

/// Whose clock a sensor time was read from. Times of different clocks are not comparable.
enum class SensorClock : std::uint8_t { Device, Recording, Synthetic, HostMonotonic };
/// By SensorClock.
inline constexpr std::array<std::string_view, 4> kSensorClockNames = {
    "device", "recording", "synthetic", "host_monotonic"};

/// Whether somebody steers.
enum class Engagement : std::uint8_t {
  NoUser,         ///< nobody in front of the sensor
  Detected,       ///< somebody is there and does not steer
  CapturingRest,  ///< stands still while the rest pose is taken
  Engaged,        ///< steers
  Suspended,      ///< steered until tracking was lost; may go on
};
/// By Engagement.
inline constexpr std::array<std::string_view, 5> kEngagementNames = {
    "no_user", "detected", "capturing_rest", "engaged", "suspended"};

/// Why both velocities are zero, whatever the body does. None: they follow the body (and may be zero all the same).
enum class StopReason : std::uint8_t {
  None, NoUser, NotEngaged, TrackingLost, RestRequested, EndOfStream, SourceFailed, Reload, Exit,
  TooNoisy,  ///< a steering motion would need too wide a dead zone to be steered with
};
/// By StopReason.
inline constexpr std::array<std::string_view, 10> kStopReasonNames = {
    "none", "no_user", "not_engaged", "tracking_lost", "rest_requested", "end_of_stream", "source_failed", "reload",
    "exit", "too_noisy"};

/// The stages of the tracker, in the order in which a frame walks through them.
enum class Stage : std::uint8_t { Segmentation, Forest, Joints, Motions, Transfer, Engagement };
/// How many there are.
inline constexpr std::size_t kStageCount = 6;
/// By Stage.
inline constexpr std::array<std::string_view, kStageCount> kStageNames = {
    "segmentation", "forest", "joints", "motions", "transfer", "engagement"};

/// What an event is about.
enum class EventKind : std::uint8_t {
  Started, Stopping, UserEntered, UserLeft, RestCaptured, Engaged, Disengaged, TrackingLost, TrackingRecovered,
  MotionTooNoisy, SourceLost, SourceRecovered, ConfigReloaded, ConfigRejected, ConfigSaved, Warning,
};
/// By EventKind.
inline constexpr std::array<std::string_view, 16> kEventKindNames = {
    "started", "stopping", "user_entered", "user_left", "rest_captured", "engaged", "disengaged", "tracking_lost",
    "tracking_recovered", "motion_too_noisy", "source_lost", "source_recovered", "config_reloaded", "config_rejected",
    "config_saved", "warning"};

/// What a client may ask of the daemon.
enum class RequestKind : std::uint8_t {
  Status,  ///< what holds
  Rerest,  ///< take the rest pose anew
  Set,     ///< change settings, until the daemon ends or reloads
  Save,    ///< write the settings to the configuration's file
  Reload,  ///< read that file again
};
/// By RequestKind.
inline constexpr std::array<std::string_view, 5> kRequestKindNames = {"status", "rerest", "set", "save", "reload"};
// clang-format on

///@{
/// How it is spelled in text.
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
///@}

}  // namespace armature::navproto
