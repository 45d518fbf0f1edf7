#include "tracker/motions/receptors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <numbers>

#include <Eigen/Geometry>

namespace armature {
namespace {

using Eigen::Vector3f;

/// A point or vector in the user's frame: x to the person's left, y up, z forward.
Vector3f in_user_frame(const UserFrame& frame, const Vector3f& v) {
  return {frame.left.dot(v), frame.up.dot(v), frame.forward.dot(v)};
}

float wrapped(float angle) {
  constexpr float kPi = std::numbers::pi_v<float>;
  if (angle > kPi) return angle - 2 * kPi;
  if (angle < -kPi) return angle + 2 * kPi;
  return angle;
}

/// How far both knees' forward coordinates must move in sum before the direction of a step is certain, metres. Nearer
/// to zero the step fades, so that noise in the sum cannot throw it from forward to backward.
constexpr float kStepDirectionSpan = 0.10F;

/// The arc tangent of y / x in its quadrant. Found in double precision and rounded, it is the same on all processors:
/// atan2f is not, its last bit depends on whether products are fused into sums.
float angle_of(float y, float x) {
  return static_cast<float>(std::atan2(static_cast<double>(y), static_cast<double>(x)));
}

/// Heading of a vector from the right to the left side, counter-clockwise seen from above.
/// Left turning backwards is counter-clockwise: z decreases as x stays positive.
float heading(const Vector3f& v) {
  return angle_of(-v.z(), v.x());
}

/// Angle of an upright vector towards the person's left and towards the front.
float towards_left(const Vector3f& v) {
  return angle_of(v.x(), v.y());
}
float towards_front(const Vector3f& v) {
  return angle_of(v.z(), v.y());
}
/// Angle of a hanging vector (from P down to a hip) towards the person's left.
float swung_left(const Vector3f& v) {
  return angle_of(v.x(), -v.y());
}

/// The joints each motion is read from. (The user position P counts through the hips it is anchored beside.)
constexpr std::array<std::initializer_list<JointId>, kMotionCount> kNeeded = {{
    {JointId::LeftShoulder, JointId::RightShoulder},
    {JointId::LeftHip, JointId::RightHip},
    {JointId::LeftShoulder, JointId::RightShoulder, JointId::LeftHip, JointId::RightHip},
    {JointId::Waist, JointId::Neck},
    {JointId::Head, JointId::LeftKnee, JointId::RightKnee},
    {JointId::LeftHip, JointId::RightHip, JointId::LeftKnee, JointId::RightKnee},
    {JointId::LeftKnee, JointId::RightKnee},
    {JointId::LeftKnee, JointId::RightKnee},
}};

}  // namespace

UserFrame user_frame(const Skeleton& rest, const Vector3f& up) noexcept {
  const auto level = [&](const Vector3f& v) -> Vector3f { return v - v.dot(up) * up; };
  Vector3f left = level(rest[JointId::LeftHip].position - rest[JointId::RightHip].position);
  if (left.norm() < 1e-3F) left = level(Vector3f::UnitX());
  left.normalize();
  return {up, left, left.cross(up)};
}

MotionAngles motion_angles(const Skeleton& now, const RestPose& rest) noexcept {
  const UserFrame& frame = rest.frame;
  const auto between = [&](const Skeleton& s, JointId from, JointId to) {
    return in_user_frame(frame, s[to].position - s[from].position);
  };
  const auto turned = [&](JointId right, JointId left) {
    return wrapped(heading(between(now, right, left)) - heading(between(rest.skeleton, right, left)));
  };
  const auto knees_middle = [](const Skeleton& s) -> Vector3f {
    return 0.5F * (s[JointId::LeftKnee].position + s[JointId::RightKnee].position);
  };

  // P is a mean over the body and follows what it should measure. Anchored to the feet it does not.
  const Vector3f knees_moved = knees_middle(now) - knees_middle(rest.skeleton);
  const Vector3f p_rest = rest.skeleton.user_position;
  const Vector3f p_now = p_rest + knees_moved;
  const auto from_p = [&](const Skeleton& s, const Vector3f& p, JointId to) {
    return in_user_frame(frame, s[to].position - p);
  };
  const auto hip_swing = [&](JointId hip) {
    return wrapped(swung_left(from_p(now, p_now, hip)) - swung_left(from_p(rest.skeleton, p_rest, hip)));
  };

  MotionAngles out;
  PerMotion<float>& angle = out.angle_rad;
  angle[index(MotionId::RotateShoulders)] = turned(JointId::RightShoulder, JointId::LeftShoulder);
  angle[index(MotionId::RotateHips)] = turned(JointId::RightHip, JointId::LeftHip);
  angle[index(MotionId::LeanBust)] = wrapped(towards_left(between(now, JointId::Waist, JointId::Neck)) -
                                             towards_left(between(rest.skeleton, JointId::Waist, JointId::Neck)));
  angle[index(MotionId::BendBust)] = wrapped(towards_front(from_p(now, p_now, JointId::Head)) -
                                             towards_front(from_p(rest.skeleton, p_rest, JointId::Head)));
  angle[index(MotionId::TranslateHips)] = 0.5F * (hip_swing(JointId::LeftHip) + hip_swing(JointId::RightHip));

  const float yaw = turned(JointId::RightKnee, JointId::LeftKnee);
  const float knees_forward = 2 * frame.forward.dot(knees_moved);  // the sum over both knees
  angle[index(MotionId::BendKnees)] = yaw;
  angle[index(MotionId::Step)] = std::abs(yaw) * std::clamp(knees_forward / kStepDirectionSpan, -1.0F, 1.0F);

  for (std::size_t m = 0; m < kMotionCount; ++m) {
    float confidence = 1;
    for (const JointId joint : kNeeded[m]) {
      confidence = std::min({confidence, now[joint].confidence, rest.skeleton[joint].confidence});
    }
    out.confidence[m] = confidence;
  }

  const float shoulders = out.confidence[index(MotionId::RotateShoulders)];
  const float hips = out.confidence[index(MotionId::RotateHips)];
  const float sum = shoulders + hips;
  angle[index(MotionId::RotateBust)] =
      sum > 0 ? (shoulders * angle[index(MotionId::RotateShoulders)] + hips * angle[index(MotionId::RotateHips)]) / sum
              : 0.0F;
  return out;
}

JointState weakest_state(const Skeleton& skeleton, MotionId motion) noexcept {
  JointState weakest = JointState::Observed;
  for (const JointId joint : kNeeded[index(motion)]) weakest = std::min(weakest, skeleton[joint].state);
  return weakest;
}

}  // namespace armature
