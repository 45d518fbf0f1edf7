#include "tracker/synth/motion_poses.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tracker/body/rotation.h"

namespace armature {
namespace {

double tangent(double angle) {
  return on_grid(std::tan(std::clamp(angle, -1.2, 1.2)));
}
double sine(double angle) {
  return on_grid(std::sin(angle));
}

/// Half the length of a leg: what a knee is displaced by follows from a right triangle with it.
double half_leg(const BodyShape& shape) {
  return 0.5 * (shape.thigh + shape.shin);
}

/// By how much the distance from hip to ankle shrinks when the knee lies `forward` of the line between them.
double shortening(const BodyShape& shape, double forward) {
  const double half = half_leg(shape);
  return 2 * (half - std::sqrt(std::max(0.0, half * half - forward * forward)));
}

/// Where the ankle of a foot that stands flat is.
Eigen::Vector3d standing_ankle(const BodyShape& shape, const FootPose& foot) {
  return foot.ball + turned_left(foot.turn) * Eigen::Vector3d(0, shape.ankle_height, -shape.foot);
}

/// Raises or lowers and tilts the pelvis by a degree or two so that the knees, which lie `forward` (left, right) before
/// the lines from hip to ankle, stay as much bent while the pelvis moves over planted feet.
void settle_pelvis(const BodyShape& shape, const std::array<double, 2>& forward, Pose& pose) {
  std::array<double, 2> height{};
  for (const Side side : {Side::Left, Side::Right}) {
    const auto i = static_cast<std::size_t>(side);
    const double length = shape.thigh + shape.shin - shortening(shape, std::max(0.004, forward[i]));
    const Eigen::Vector3d ankle = standing_ankle(shape, pose.feet[i]);
    const Eigen::Vector3d hip =
        pose.pelvis + outward(side) * shape.hip_half_width * turned_left(pose.pelvis_turns.turn).col(0);
    const double dx = hip.x() - ankle.x(), dz = hip.z() - ankle.z();
    height[i] = ankle.y() + std::sqrt(std::max(0.0, length * length - dx * dx - dz * dz));
  }
  const double lean = on_grid(std::asin(std::clamp((height[1] - height[0]) / (2 * shape.hip_half_width), -0.25, 0.25)));
  pose.pelvis.y() = 0.5 * (height[0] + height[1]);
  pose.spine.lean -= lean - pose.pelvis_turns.lean;
  pose.pelvis_turns.lean = lean;
}

/// Turning the pelvis moves one hip forward, the other back, and would take the knees along by half. Straightening one
/// leg a little and bending the other keeps them over the feet.
void rotate_hips(double amount, const BodyShape& shape, Pose& pose) {
  const double moved = 0.5 * shape.hip_half_width * sine(amount);  // right knee forward, left knee back
  const double soft = knee_forward(shape, pose);
  pose.pelvis_turns.turn += amount;
  pose.spine.turn -= amount;
  settle_pelvis(shape, {soft + moved, soft - moved}, pose);
}

void translate_hips(double amount, const BodyShape& shape, Pose& pose) {
  const double soft = knee_forward(shape, pose);
  pose.pelvis.x() += 2.2 * 0.2 * tangent(amount) * shape.stature / 1.75;
  settle_pelvis(shape, {soft, soft}, pose);
}

void bend_knee(const Performance& performance, const BodyShape& shape, Pose& pose) {
  const Side side = performance.amount > 0 ? Side::Right : Side::Left;
  FootPose& foot = pose.foot(side);
  const double apart = std::abs(pose.foot(Side::Left).ball.x() - pose.foot(Side::Right).ball.x());
  const double forward = tangent(std::abs(performance.amount)) * 0.5 * (apart + 2 * shape.hip_half_width);
  const double soft = knee_forward(shape, pose);
  // The ball of the foot stays; the heel rises by what the leg shortens, and takes the ankle a little forward.
  const double rise = shortening(shape, soft + 0.9 * forward) - shortening(shape, soft);
  foot.pitch += on_grid(std::asin(std::clamp(rise / (1.05 * shape.foot), 0.0, 0.85)));
}

void step(const Performance& performance, const BodyShape& shape, Pose& pose) {
  const double stride = 4.2 * tangent(performance.amount) * shape.hip_half_width;
  FootPose& foot = pose.foot(performance.leading);
  FootPose& other = pose.foot(performance.leading == Side::Left ? Side::Right : Side::Left);
  foot.ball.z() += stride;
  foot.ball.y() += performance.lift;
  pose.pelvis.z() += 0.5 * stride;
  // The rear heel rises.
  FootPose& rear = stride > 0 ? other : foot;
  rear.pitch += std::min(0.7, 0.9 * std::abs(stride));
}

}  // namespace

double knee_forward(const BodyShape& shape, const Pose& pose) {
  const double sunk = std::max(0.0, standing_hip_height(shape) - pose.pelvis.y());
  const double half = half_leg(shape);
  const double along = half - 0.5 * sunk;
  return std::max(0.01, std::sqrt(std::max(0.0, half * half - along * along)));
}

void perform(MotionId motion, const Performance& performance, const BodyShape& shape, Pose& pose) {
  const double amount = performance.amount;
  switch (motion) {
    case MotionId::RotateShoulders:
      pose.twist += amount;
      pose.neck.turn -= 0.8 * amount;
      break;
    case MotionId::RotateHips: rotate_hips(amount, shape, pose); break;
    case MotionId::RotateBust:
      rotate_hips(amount, shape, pose);
      pose.twist += amount;
      pose.neck.turn -= 0.8 * amount;
      break;
    case MotionId::LeanBust:
      pose.spine.lean += 1.25 * amount;
      pose.neck.lean -= 0.6 * amount;
      break;
    case MotionId::BendBust:
      pose.spine.bend += 1.2 * amount;
      pose.neck.bend -= 0.5 * amount;
      break;
    case MotionId::TranslateHips: translate_hips(amount, shape, pose); break;
    case MotionId::BendKnees:
      if (amount != 0) bend_knee(performance, shape, pose);
      break;
    case MotionId::Step:
      if (amount != 0) step(performance, shape, pose);
      break;
  }
}

}  // namespace armature
