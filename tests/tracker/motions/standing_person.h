#pragma once

#include <initializer_list>

#include <Eigen/Geometry>

#include "tracker/motions/receptors.h"

namespace armature::test {

/// Somebody of 1.7 m who stands 2.5 m in front of a level camera at hip height and faces it.
inline Skeleton standing_person() {
  Skeleton s;
  const auto put = [&](JointId joint, float x, float y, float z) {
    s[joint] = {.position = {x, y, 2.5F + z}, .confidence = 1, .state = JointState::Observed};
  };
  using enum JointId;
  put(HeadTop, 0, -0.80F, 0), put(Head, 0, -0.70F, 0), put(Neck, 0, -0.55F, 0), put(Chest, 0, -0.40F, 0);
  put(Torso, 0, -0.20F, 0), put(Waist, 0, -0.05F, 0);
  for (const float side : {1.0F, -1.0F}) {
    const auto put_side = [&](JointId left, float x, float y) {
      put(side > 0 ? left : mirrored(left), side * x, y, 0);
    };
    put_side(LeftCollar, 0.08F, -0.52F), put_side(LeftShoulder, 0.18F, -0.50F), put_side(LeftUpperArm, 0.20F, -0.35F);
    put_side(LeftElbow, 0.22F, -0.20F), put_side(LeftForearm, 0.22F, -0.08F), put_side(LeftWrist, 0.22F, 0.03F);
    put_side(LeftHand, 0.22F, 0.10F), put_side(LeftHip, 0.11F, 0.05F), put_side(LeftThigh, 0.12F, 0.27F);
    put_side(LeftKnee, 0.13F, 0.48F), put_side(LeftAnkle, 0.13F, 0.88F), put_side(LeftFoot, 0.13F, 0.92F);
  }
  s.user_position = {0, -0.2F, 2.4F};
  return s;
}

inline RestPose resting(const Skeleton& skeleton) {
  return {skeleton, user_frame(skeleton, -Eigen::Vector3f::UnitY())};
}

/// The joints turned about a vertical axis through `about`, counter-clockwise seen from above (to the person's left).
inline void turn(Skeleton& s, std::initializer_list<JointId> joints, const Eigen::Vector3f& about, float angle_rad) {
  const Eigen::Matrix3f rotation = Eigen::AngleAxisf(-angle_rad, Eigen::Vector3f::UnitY()).matrix();  // y points down
  for (const JointId joint : joints) s[joint].position = about + rotation * (s[joint].position - about);
}

}  // namespace armature::test
