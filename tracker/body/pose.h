#pragma once

#include <array>

#include <Eigen/Core>

#include "tracker/body/body_shape.h"

namespace armature {

/// Poses are in the body's own frame: x to the person's left, y up, z forward, metres; origin on the floor between the
/// feet of the standing person. Angles in radians, positive as in rotation.h.

enum class Side : int { Left = 0, Right = 1 };
/// +1 for left, -1 for right: the sign of "outward" along x.
[[nodiscard]] constexpr double outward(Side side) noexcept {
  return side == Side::Left ? 1.0 : -1.0;
}

/// Three rotations, applied lean first, then bend, then turn.
struct Turns {
  double turn = 0;
  double bend = 0;
  double lean = 0;
};

/// Where the wrist is, seen from the shoulder, along (outward, up, forward) of the chest, in arm lengths (1 =
/// straight). The elbow follows: below and behind, then swivelled about the line from shoulder to wrist, outward
/// positive.
struct ArmPose {
  Eigen::Vector3d wrist{0.12, -0.97, 0.06};
  double elbow_swivel = 0;
  double hangs = 0.6;     ///< 0 = moves with the chest, 1 = keeps its direction to gravity as the chest tilts
  double wrist_flex = 0;  ///< of the hand against the forearm, towards the palm
};

/// Where the foot stands: the point of the floor under the ball of the foot. The ankle follows.
struct FootPose {
  Eigen::Vector3d ball = Eigen::Vector3d::Zero();
  double turn = 0;      ///< about the vertical, positive to the left
  double pitch = 0;     ///< positive: heel raised, the ball stays; negative: toes raised, the heel stays
  double knee_out = 0;  ///< the direction in which the knee points, outward of the foot's
};

struct Pose {
  Eigen::Vector3d pelvis{0, 0.92, 0};  ///< midpoint of the hip joints; lowered where the feet could not be reached
  Turns pelvis_turns;
  Turns spine;       ///< chest against pelvis, spread over the spine
  double twist = 0;  ///< of the spine about its own axis, before those: turns the shoulders without changing the axis
  Turns neck;        ///< head against chest
  std::array<ArmPose, 2> arms;
  std::array<double, 2> shrug{};  ///< shoulder joints raised, metres
  std::array<double, 2> reach{};  ///< shoulder joints drawn forward, metres
  std::array<FootPose, 2> feet;

  [[nodiscard]] ArmPose& arm(Side side) noexcept { return arms[static_cast<std::size_t>(side)]; }
  [[nodiscard]] FootPose& foot(Side side) noexcept { return feet[static_cast<std::size_t>(side)]; }
  [[nodiscard]] const ArmPose& arm(Side side) const noexcept { return arms[static_cast<std::size_t>(side)]; }
  [[nodiscard]] const FootPose& foot(Side side) const noexcept { return feet[static_cast<std::size_t>(side)]; }
};

/// What a healthy adult reaches without effort; a pose beyond is pulled back to it.
struct PoseLimits {
  Turns spine{1.0, 1.3, 0.7};  ///< +- ; bending backward is limited to kSpineBackward
  Turns neck{1.2, 0.8, 0.6};
  double reach_min = 0.22;  ///< wrist from shoulder, arm lengths: the elbow fully flexed
  double reach_max = 0.995;
};
inline constexpr double kSpineBackward = -0.6;

/// Standing upright, arms hanging. `stance` is the distance between the balls of the feet over that of the hip joints,
/// `soft_knees` how far the hips sink below straight legs, metres.
[[nodiscard]] Pose standing_pose(const BodyShape& shape, double stance = 1.2, double soft_knees = 0.006) noexcept;

/// The pose within the limits.
[[nodiscard]] Pose limited(const Pose& pose, const PoseLimits& limits = {}) noexcept;

/// Every number of the pose between those of `a` (share 0) and `b` (share 1).
[[nodiscard]] Pose blended(const Pose& a, const Pose& b, double share) noexcept;

/// The pose reflected in the plane between left and right.
[[nodiscard]] Pose mirrored(const Pose& pose) noexcept;

}  // namespace armature
