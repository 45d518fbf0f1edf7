#pragma once

#include <array>

#include <Eigen/Core>

#include "tracker/body/body_parts.h"
#include "tracker/body/body_shape.h"
#include "tracker/body/pose.h"

namespace armature {

/// A body in a pose: the joints and the axes of the rigid parts, in the body's own frame (pose.h).
///
/// Where the joints lie:
///   head_top    crown, on the skin                    shoulder   centre of the glenohumeral joint
///   head        centre of the cranium                 upper_arm  middle of the humerus
///   neck        base of the neck, on the shoulder     elbow      centre of the elbow
///               line (C7)                             forearm    middle of the forearm
///   chest       spine, 3/4 from hip to shoulder line  wrist      centre of the wrist
///   torso       spine, 0.55 of that way               hand       centre of the palm
///   waist       lumbar spine, 0.2 of that way         hip        centre of the hip joint
///   collar      middle of the clavicle                thigh      middle of the femur
///   knee        centre of the knee                    ankle      centre of the ankle
///   foot        ball of the foot
struct PosedBody {
  std::array<Eigen::Vector3d, kJointCount> joints;
  Eigen::Vector3d pelvis_centre;  ///< midpoint of the hip joints
  /// Columns left, up, forward of the rigid parts; the belly's lie between pelvis and chest, the neck's between chest
  /// and head.
  Eigen::Matrix3d pelvis, belly, chest, neck, head;
  std::array<Eigen::Matrix3d, 2> feet;             ///< indexed by Side
  std::array<Eigen::Vector3d, 2> hand_directions;  ///< from wrist to knuckles, unit
  std::array<Eigen::Vector3d, 2> knee_directions;  ///< where the knees point, unit, across the line hip to ankle

  [[nodiscard]] const Eigen::Vector3d& operator[](JointId joint) const noexcept { return joints[index(joint)]; }
};

/// The joint of this side, given that of the left one.
[[nodiscard]] constexpr JointId on_side(JointId left_joint, Side side) noexcept {
  return side == Side::Left ? left_joint : mirrored(left_joint);
}
[[nodiscard]] constexpr PartLabel on_side(PartLabel left_part, Side side) noexcept {
  return side == Side::Left ? left_part : mirrored(left_part);
}

/// Forward kinematics of spine and head; two-bone inverse kinematics of arms (from the wrists) and legs (from the
/// feet). Bone lengths are those of the shape, always. The pelvis sinks until both feet can be reached; a foot that is
/// still too far leaves its place.
[[nodiscard]] PosedBody pose_body(const BodyShape& shape, const Pose& pose) noexcept;

}  // namespace armature
