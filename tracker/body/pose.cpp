#include "tracker/body/pose.h"

#include <algorithm>

namespace armature {

Pose standing_pose(const BodyShape& shape, double stance, double soft_knees) noexcept {
  Pose pose;
  pose.pelvis = {0, standing_hip_height(shape) - soft_knees, 0};
  for (const Side side : {Side::Left, Side::Right}) {
    FootPose& foot = pose.foot(side);
    foot.turn = outward(side) * 0.12;
    foot.ball = {outward(side) * stance * shape.hip_half_width, 0, shape.foot};
  }
  return pose;
}

Pose limited(const Pose& pose, const PoseLimits& limits) noexcept {
  Pose out = pose;
  const auto clamp = [](Turns& turns, const Turns& limit, double backward) {
    turns.turn = std::clamp(turns.turn, -limit.turn, limit.turn);
    turns.bend = std::clamp(turns.bend, backward, limit.bend);
    turns.lean = std::clamp(turns.lean, -limit.lean, limit.lean);
  };
  clamp(out.spine, limits.spine, kSpineBackward);
  clamp(out.neck, limits.neck, -limits.neck.bend);
  for (ArmPose& arm : out.arms) {
    const double reach = arm.wrist.norm();
    if (reach < 1e-6) {
      arm.wrist = {0, -limits.reach_min, 0};
    } else {
      arm.wrist *= std::clamp(reach, limits.reach_min, limits.reach_max) / reach;
    }
  }
  return out;
}

Pose mirrored(const Pose& pose) noexcept {
  Pose out = pose;
  out.pelvis.x() = -out.pelvis.x();
  for (Turns* turns : {&out.pelvis_turns, &out.spine, &out.neck}) {
    turns->turn = -turns->turn;
    turns->lean = -turns->lean;
  }
  std::swap(out.arms[0], out.arms[1]);
  std::swap(out.shrug[0], out.shrug[1]);
  std::swap(out.feet[0], out.feet[1]);
  for (FootPose& foot : out.feet) {
    foot.ball.x() = -foot.ball.x();
    foot.turn = -foot.turn;
  }
  return out;
}

}  // namespace armature
