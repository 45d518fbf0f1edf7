#pragma once

#include <Eigen/Core>

#include "tracker/body/skeleton.h"
#include "tracker/motions/motion.h"

namespace armature {

/// The frame in which motions are measured (section 3.3.2): orthonormal, right-handed, in camera coordinates.
struct UserFrame {
  Eigen::Vector3f up = -Eigen::Vector3f::UnitY();       ///< away from the floor
  Eigen::Vector3f left = Eigen::Vector3f::UnitX();      ///< the person's left: from the right to the left hip, level
  Eigen::Vector3f forward = -Eigen::Vector3f::UnitZ();  ///< where the person looks in the rest pose: left x up
};

/// The pose against which motions are measured.
struct RestPose {
  Skeleton skeleton;
  UserFrame frame;
};

/// The frame of a person who stands with these joints on a floor with this normal (unit, pointing up). A person seen
/// from the front whose hips coincide gets the camera's own axes, made level.
[[nodiscard]] UserFrame user_frame(const Skeleton& rest, const Eigen::Vector3f& up) noexcept;

/// A signed angle per motion, radians, and the confidence of each in [0, 1] (that of its weakest joint,
/// now or at rest: what was not seen there has not moved from anywhere).
/// Positive is to the person's left (rotations counter-clockwise seen from above, lean, translate), forward (bend
/// bust, step), right knee forward (bend knees).
struct MotionAngles {
  PerMotion<float> angle_rad{};
  PerMotion<float> confidence{};
};

/// The seven motion receptors of section 3.3.2 and rotate_bust. Both skeletons in the camera frame.
/// Realtime-safe: yes.
[[nodiscard]] MotionAngles motion_angles(const Skeleton& now, const RestPose& rest) noexcept;

/// The vector of the joints that a motion needs, for states and confidences.
[[nodiscard]] JointState weakest_state(const Skeleton& skeleton, MotionId motion) noexcept;

}  // namespace armature
