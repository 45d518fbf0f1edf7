#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace armature {

// The lists are laid out as the body is.
// clang-format off

/// The skeleton's joints. Left is the person's own.
enum class JointId : std::uint8_t {
  HeadTop, Head, Neck, Chest, Torso, Waist,
  LeftCollar, LeftShoulder, LeftUpperArm, LeftElbow, LeftForearm, LeftWrist, LeftHand,
  LeftHip, LeftThigh, LeftKnee, LeftAnkle, LeftFoot,
  RightCollar, RightShoulder, RightUpperArm, RightElbow, RightForearm, RightWrist, RightHand,
  RightHip, RightThigh, RightKnee, RightAnkle, RightFoot,
};
inline constexpr int kJointCount = 30;

/// Joint names as the wire and the JSON output spell them, in the order of JointId.
inline constexpr std::array<std::string_view, kJointCount> kJointNames = {
    "head_top", "head", "neck", "chest", "torso", "waist",
    "left_collar", "left_shoulder", "left_upper_arm", "left_elbow", "left_forearm", "left_wrist", "left_hand",
    "left_hip", "left_thigh", "left_knee", "left_ankle", "left_foot",
    "right_collar", "right_shoulder", "right_upper_arm", "right_elbow", "right_forearm", "right_wrist", "right_hand",
    "right_hip", "right_thigh", "right_knee", "right_ankle", "right_foot",
};

/// The body parts that the forest tells apart (Shotton et al. 2011, section 3.1). Left is the person's own.
enum class PartLabel : std::uint8_t {
  HeadTopLeft, HeadTopRight, HeadLeft, HeadRight, Neck,
  LeftClavicle, LeftShoulder, LeftUpperArm, LeftElbow, LeftForearm, LeftWrist, LeftHand,
  LeftWaist, LeftHip, LeftThigh, LeftKnee, LeftShin, LeftFoot,
  RightClavicle, RightShoulder, RightUpperArm, RightElbow, RightForearm, RightWrist, RightHand,
  RightWaist, RightHip, RightThigh, RightKnee, RightShin, RightFoot,
};
// clang-format on

inline constexpr int kPartCount = 31;
inline constexpr std::uint8_t kNoPart = 255;  ///< a pixel of no person

[[nodiscard]] constexpr std::size_t index(JointId joint) noexcept {
  return static_cast<std::size_t>(joint);
}
[[nodiscard]] constexpr std::size_t index(PartLabel part) noexcept {
  return static_cast<std::size_t>(part);
}

/// The parts whose visible pixels' centre of mass is the user position P: clavicles, waist and hips of both sides.
[[nodiscard]] constexpr bool is_torso(PartLabel part) noexcept {
  return part == PartLabel::LeftClavicle || part == PartLabel::LeftWaist || part == PartLabel::LeftHip ||
         part == PartLabel::RightClavicle || part == PartLabel::RightWaist || part == PartLabel::RightHip;
}

/// The same joint or part of the other side of the body; those on the midline map to themselves.
[[nodiscard]] constexpr JointId mirrored(JointId joint) noexcept {
  const auto i = static_cast<int>(joint);
  if (i < 6) return joint;
  return static_cast<JointId>(i < 18 ? i + 12 : i - 12);
}
[[nodiscard]] constexpr PartLabel mirrored(PartLabel part) noexcept {
  const auto i = static_cast<int>(part);
  if (i == 4) return part;
  if (i < 4) return static_cast<PartLabel>(i ^ 1);
  return static_cast<PartLabel>(i < 18 ? i + 13 : i - 13);
}

}  // namespace armature
