#pragma once

#include <cstdint>
#include <initializer_list>

#include "tracker/body/body_parts.h"

namespace armature {

/// The parts around a joint, as bits of 1 << PartLabel: only pixels of these parts know where the joint is. A pixel of
/// a hand can vote for the shoulder, but the arm between them moves.
[[nodiscard]] constexpr std::uint32_t parts_around(JointId joint) noexcept {
  using enum PartLabel;
  const auto bits = [](std::initializer_list<PartLabel> parts) {
    std::uint32_t set = 0;
    for (const PartLabel part : parts) set |= 1U << index(part);
    return set;
  };
  switch (joint) {
    case JointId::HeadTop: return bits({HeadTopLeft, HeadTopRight, HeadLeft, HeadRight});
    case JointId::Head: return bits({HeadTopLeft, HeadTopRight, HeadLeft, HeadRight, Neck});
    case JointId::Neck: return bits({HeadLeft, HeadRight, Neck, LeftClavicle, RightClavicle});
    case JointId::Chest:
      return bits({Neck, LeftClavicle, RightClavicle, LeftShoulder, RightShoulder, LeftWaist, RightWaist});
    case JointId::Torso: return bits({LeftClavicle, RightClavicle, LeftWaist, RightWaist});
    case JointId::Waist: return bits({LeftWaist, RightWaist, LeftHip, RightHip});
    case JointId::LeftCollar: return bits({Neck, LeftClavicle, LeftShoulder});
    case JointId::LeftShoulder: return bits({LeftClavicle, LeftShoulder, LeftUpperArm});
    case JointId::LeftUpperArm: return bits({LeftShoulder, LeftUpperArm, LeftElbow});
    case JointId::LeftElbow: return bits({LeftUpperArm, LeftElbow, LeftForearm});
    case JointId::LeftForearm: return bits({LeftElbow, LeftForearm, LeftWrist});
    case JointId::LeftWrist: return bits({LeftForearm, LeftWrist, LeftHand});
    case JointId::LeftHand: return bits({LeftWrist, LeftHand});
    case JointId::LeftHip: return bits({LeftWaist, LeftHip, LeftThigh});
    case JointId::LeftThigh: return bits({LeftHip, LeftThigh, LeftKnee});
    case JointId::LeftKnee: return bits({LeftThigh, LeftKnee, LeftShin});
    case JointId::LeftAnkle: return bits({LeftShin, LeftFoot});
    case JointId::LeftFoot: return bits({LeftShin, LeftFoot});
    default: break;
  }
  const std::uint32_t left = parts_around(mirrored(joint));
  std::uint32_t right = 0;
  for (int part = 0; part < kPartCount; ++part) {
    if ((left >> part & 1U) != 0) right |= 1U << index(mirrored(static_cast<PartLabel>(part)));
  }
  return right;
}

}  // namespace armature
