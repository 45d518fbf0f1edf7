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
  out.twist = std::clamp(out.twist, -limits.spine.turn, limits.spine.turn);
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

Pose blended(const Pose& a, const Pose& b, double share) noexcept {
  const auto mix = [share](const auto& from, const auto& to) { return from + share * (to - from); };
  const auto vector = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) -> Eigen::Vector3d {
    return from + share * (to - from);
  };
  const auto turns = [&](const Turns& from, const Turns& to) {
    return Turns{mix(from.turn, to.turn), mix(from.bend, to.bend), mix(from.lean, to.lean)};
  };
  Pose out;
  out.pelvis = vector(a.pelvis, b.pelvis);
  out.pelvis_turns = turns(a.pelvis_turns, b.pelvis_turns);
  out.spine = turns(a.spine, b.spine);
  out.twist = mix(a.twist, b.twist);
  out.neck = turns(a.neck, b.neck);
  for (std::size_t i = 0; i < 2; ++i) {
    const ArmPose &aa = a.arms[i], &ba = b.arms[i];
    out.arms[i] = {vector(aa.wrist, ba.wrist), mix(aa.elbow_swivel, ba.elbow_swivel), mix(aa.hangs, ba.hangs),
                   mix(aa.wrist_flex, ba.wrist_flex)};
    out.shrug[i] = mix(a.shrug[i], b.shrug[i]);
    out.reach[i] = mix(a.reach[i], b.reach[i]);
    const FootPose &af = a.feet[i], &bf = b.feet[i];
    out.feet[i] = {vector(af.ball, bf.ball), mix(af.turn, bf.turn), mix(af.pitch, bf.pitch),
                   mix(af.knee_out, bf.knee_out)};
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
  out.twist = -out.twist;
  std::swap(out.arms[0], out.arms[1]);
  std::swap(out.shrug[0], out.shrug[1]);
  std::swap(out.reach[0], out.reach[1]);
  std::swap(out.feet[0], out.feet[1]);
  for (FootPose& foot : out.feet) {
    foot.ball.x() = -foot.ball.x();
    foot.turn = -foot.turn;
  }
  return out;
}

}  // namespace armature
