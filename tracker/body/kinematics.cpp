#include "tracker/body/kinematics.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "tracker/body/rotation.h"

namespace armature {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Shares of the way from the hip line to the shoulder line. The spine turns in the lumbar and in the thoracic one.
constexpr double kLumbar = 0.20;
constexpr double kThoracic = 0.55;
constexpr double kChest = 0.75;
/// Legs and arms never straighten quite: the knee's direction would be lost.
constexpr double kStraight = 0.9995;

Matrix3d rotation(const Turns& turns, double share = 1) {
  return turned_left(share * turns.turn) * bent_forward(share * turns.bend) * leaned_left(share * turns.lean);
}

/// The middle joint of two bones from `root` towards `end`, on the side of `pole`. Moves `end` where it is out of
/// reach.
Vector3d two_bone_joint(const Vector3d& root, Vector3d& end, double first, double second, const Vector3d& pole,
                        Vector3d* direction = nullptr) {
  const double reach = kStraight * (first + second);
  const double least = std::abs(first - second) + 1e-3;
  Vector3d line = end - root;
  double distance = line.norm();
  line = distance > 1e-9 ? Vector3d(line / distance) : Vector3d(-Vector3d::UnitY());
  if (distance > reach || distance < least) {
    distance = std::clamp(distance, least, reach);
    end = root + distance * line;
  }
  Vector3d across = pole - pole.dot(line) * line;
  if (across.squaredNorm() < 1e-8) across = line.unitOrthogonal();
  across.normalize();
  if (direction != nullptr) *direction = across;
  const double along = (first * first - second * second + distance * distance) / (2 * distance);
  return root + along * line + std::sqrt(std::max(0.0, first * first - along * along)) * across;
}

struct AnkleAndBall {
  Matrix3d axes;
  Vector3d ankle;
  Vector3d ball;
};

AnkleAndBall place_foot(const BodyShape& shape, const FootPose& foot) {
  const Matrix3d turned = turned_left(foot.turn);
  const Matrix3d axes = turned * bent_forward(foot.pitch);
  const Vector3d ankle_from_ball{0, shape.ankle_height, -shape.foot};
  if (foot.pitch >= 0) return {axes, foot.ball + axes * ankle_from_ball, foot.ball};
  const Vector3d ball_from_heel{0, 0, 1.35 * shape.foot};
  const Vector3d heel = foot.ball - turned * ball_from_heel;
  const Vector3d ball = heel + axes * ball_from_heel;
  return {axes, ball + axes * ankle_from_ball, ball};
}

/// The axes in which an arm is posed: the chest's, made upright by as much as the arm hangs.
Matrix3d arm_axes(const Matrix3d& chest, const ArmPose& arm) {
  const double hangs = arm.hangs * std::clamp(-arm.wrist.y() / arm.wrist.norm(), 0.0, 1.0);
  Matrix3d axes;
  axes.col(1) = ((1 - hangs) * chest.col(1) + hangs * Vector3d::UnitY()).normalized();
  axes.col(0) = (chest.col(0) - chest.col(0).dot(axes.col(1)) * axes.col(1)).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

void place_arm(const BodyShape& shape, const Pose& pose, Side side, PosedBody& body) {
  const auto at = [&](JointId left) -> Vector3d& { return body.joints[index(on_side(left, side))]; };
  const auto i = static_cast<std::size_t>(side);
  const ArmPose& arm = pose.arms[i];
  // The shoulder joint rises with the arm (about a third of the arm's elevation above 45 degrees).
  const double raised = std::clamp(0.7 + arm.wrist.y() / arm.wrist.norm(), 0.0, 1.7) / 1.7;
  const double rise = pose.shrug[i] + 0.30 * shape.shoulder_half_width * raised;
  const double half_width = shape.shoulder_half_width * (1 - 0.12 * raised);
  const Vector3d& neck = body.joints[index(JointId::Neck)];
  const Vector3d shoulder =
      neck + body.chest * Vector3d(outward(side) * half_width, rise - shape.shoulder_drop, pose.reach[i]);

  const Matrix3d axes = arm_axes(body.chest, arm);
  const auto in_axes = [&](const Vector3d& v) -> Vector3d {
    return axes * Vector3d(outward(side) * v.x(), v.y(), v.z());
  };
  const double length = shape.upper_arm + shape.forearm;
  Vector3d wrist = shoulder + length * in_axes(arm.wrist);
  const Vector3d line = arm.wrist.normalized();
  // Elbows point down, back and a little outward.
  Vector3d pole{0.35, -0.75, -0.55};
  pole -= pole.dot(line) * line;
  const double c = on_grid(std::cos(arm.elbow_swivel)), s = on_grid(std::sin(arm.elbow_swivel));
  const Vector3d elbow =
      two_bone_joint(shoulder, wrist, shape.upper_arm, shape.forearm, in_axes(c * pole - s * line.cross(pole)));

  const Vector3d forearm = (wrist - elbow) / shape.forearm;
  Vector3d flexed = shoulder - elbow;
  flexed -= flexed.dot(forearm) * forearm;
  if (flexed.squaredNorm() < 1e-8) flexed = in_axes(Vector3d::UnitZ());
  flexed.normalize();
  const double cf = on_grid(std::cos(arm.wrist_flex)), sf = on_grid(std::sin(arm.wrist_flex));
  body.hand_directions[i] = (cf * forearm + sf * flexed).normalized();

  at(JointId::LeftCollar) = 0.5 * (neck + shoulder);
  at(JointId::LeftShoulder) = shoulder;
  at(JointId::LeftUpperArm) = 0.5 * (shoulder + elbow);
  at(JointId::LeftElbow) = elbow;
  at(JointId::LeftForearm) = 0.5 * (elbow + wrist);
  at(JointId::LeftWrist) = wrist;
  at(JointId::LeftHand) = wrist + 0.8 * shape.hand * body.hand_directions[i];
}

}  // namespace

PosedBody pose_body(const BodyShape& shape, const Pose& pose) noexcept {
  PosedBody body;
  const auto at = [&](JointId joint) -> Vector3d& { return body.joints[index(joint)]; };
  body.pelvis = rotation(pose.pelvis_turns);
  body.belly = body.pelvis * rotation(pose.spine, 0.5) * turned_left(0.5 * pose.twist);
  body.chest = body.pelvis * rotation(pose.spine) * turned_left(pose.twist);
  body.neck = body.chest * rotation(pose.neck, 0.5);
  body.head = body.chest * rotation(pose.neck);

  Vector3d centre = pose.pelvis;
  const double leg = kStraight * (shape.thigh + shape.shin);
  const auto hip_from_centre = [&](Side side) -> Vector3d {
    return outward(side) * shape.hip_half_width * body.pelvis.col(0);
  };
  std::array<AnkleAndBall, 2> feet{};
  for (const Side side : {Side::Left, Side::Right}) {
    feet[static_cast<std::size_t>(side)] = place_foot(shape, pose.foot(side));
    const Vector3d hip = centre + hip_from_centre(side);
    const Vector3d to_ankle = feet[static_cast<std::size_t>(side)].ankle - hip;
    const double level2 = to_ankle.x() * to_ankle.x() + to_ankle.z() * to_ankle.z();
    const double height = std::sqrt(std::max(0.0, leg * leg - level2));
    if (level2 < leg * leg) centre.y() -= std::max(0.0, -to_ankle.y() - height);
  }
  body.pelvis_centre = centre;

  at(JointId::Waist) = centre + kLumbar * shape.torso * body.pelvis.col(1);
  at(JointId::Torso) = at(JointId::Waist) + (kThoracic - kLumbar) * shape.torso * body.belly.col(1);
  at(JointId::Chest) = at(JointId::Torso) + (kChest - kThoracic) * shape.torso * body.chest.col(1);
  at(JointId::Neck) = at(JointId::Torso) + (1 - kThoracic) * shape.torso * body.chest.col(1);
  at(JointId::Head) = at(JointId::Neck) + shape.neck * (0.45 * body.neck.col(1) + 0.55 * body.head.col(1)) +
                      0.06 * shape.neck * body.chest.col(2);
  at(JointId::HeadTop) = at(JointId::Head) + 0.079 * shape.head_scale * body.head.col(1);

  for (const Side side : {Side::Left, Side::Right}) {
    const auto i = static_cast<std::size_t>(side);
    const auto mine = [&](JointId left) -> Vector3d& { return at(on_side(left, side)); };
    AnkleAndBall& foot = feet[i];
    const Vector3d hip = centre + hip_from_centre(side);
    const Vector3d planted = foot.ankle;
    const double knee_turn = pose.feet[i].turn + outward(side) * pose.feet[i].knee_out;
    const Vector3d knee = two_bone_joint(hip, foot.ankle, shape.thigh, shape.shin, turned_left(knee_turn).col(2),
                                         &body.knee_directions[i]);
    body.feet[i] = foot.axes;
    mine(JointId::LeftHip) = hip;
    mine(JointId::LeftThigh) = 0.5 * (hip + knee);
    mine(JointId::LeftKnee) = knee;
    mine(JointId::LeftAnkle) = foot.ankle;
    mine(JointId::LeftFoot) = foot.ball + (foot.ankle - planted) + 0.4 * shape.ankle_height * foot.axes.col(1);
    place_arm(shape, pose, side, body);
  }
  return body;
}

}  // namespace armature
