#pragma once

#include "tracker/body/pose.h"
#include "tracker/motions/motion.h"

namespace armature {

/// How a motion of section 3.3.1 is performed.
struct Performance {
  double amount = 0;           ///< signed as the motion's angle (motions/receptors.h) and close to it, radians
  Side leading = Side::Right;  ///< the foot that steps
  double lift = 0;             ///< how high the stepping foot is in the air now, metres
};

/// Adds one motion to a standing pose. Whatever the motion does not need stays: feet planted, hips over them, eyes
/// ahead. Several motions can be added to one pose.
void perform(MotionId motion, const Performance& performance, const BodyShape& shape, Pose& pose);

/// How far a softly bent knee lies before the line from hip to ankle in this pose, metres; at least 1 cm.
[[nodiscard]] double knee_forward(const BodyShape& shape, const Pose& pose);

}  // namespace armature
