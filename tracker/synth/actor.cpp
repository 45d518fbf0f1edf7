#include "tracker/synth/actor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tracker/body/rotation.h"
#include "tracker/synth/motion_poses.h"
#include "tracker/synth/random_poses.h"

namespace armature {
namespace {

using Eigen::Vector3d;

double wave(double turns) {
  return on_grid(std::sin(2 * std::numbers::pi * turns));
}
double smooth(double share) {
  return share * share * (3 - 2 * share);
}
double smooth_rate(double share) {
  return 6 * share * (1 - share);
}

/// The seed of an actor's i-th drawing beside its habits.
std::uint64_t drawing(std::uint64_t seed, std::size_t i) {
  return scrambled(seed + i) | (seed & kHeldOut);
}

}  // namespace

double MotionCalibration::amount_for(double value) const noexcept {
  std::size_t i = 1;
  while (i + 1 < values.size() && values[i] < value) ++i;
  const double share = (value - values[i - 1]) / (values[i] - values[i - 1]);
  return amounts[i - 1] + share * (amounts[i] - amounts[i - 1]);
}

struct Actor::Travel {
  double x = 0, nearer = 0, heading = 0;
  double distance = 0;   ///< walked so far
  double walking = 0;    ///< how much of her is walking, in [0, 1]
  double turning = 0;    ///< how much of her steps on the spot to turn
  double direction = 1;  ///< of the steps against the heading: forwards or backwards
};

Actor::Actor(const Person& person, const ActorScript& script, const RigidTransform& where, std::uint64_t seed)
    : person_(person), script_(&script), where_(where) {
  Random random(seed);
  const BodyShape& shape = person_.shape;
  const double soft_knees = random.uniform(0.006, 0.010);
  resting_ = standing_pose(shape, random.uniform(0.85, 1.5), soft_knees);
  for (const Side side : {Side::Left, Side::Right}) {
    ArmPose& arm = resting_.arm(side);
    arm.wrist = {random.uniform(0.06, 0.16), -random.uniform(0.94, 0.98), random.uniform(0.0, 0.10)};
    arm.elbow_swivel = random.uniform(-0.1, 0.4);
    resting_.foot(side).turn = outward(side) * random.uniform(0.02, 0.25);
    resting_.foot(side).knee_out = -0.8 * std::abs(resting_.foot(side).turn);  // knees bend straight ahead
    resting_.foot(side).ball.z() += random.uniform(-0.015, 0.015);
  }
  resting_.neck.bend = random.uniform(-0.05, 0.12);
  ArmPose& busy = resting_.arm(person_.outfit.bag_side);
  using Bag = Outfit::Bag;
  if (person_.outfit.bag == Bag::Mug) busy = {{-0.05, -0.28, 0.52}, 0.1, 0.2, 0};
  if (person_.outfit.bag == Bag::Phone) busy = {{-0.02, 0.26, 0.20}, 0.3, 0.0, 0.4};
  if (person_.outfit.bag == Bag::Hand) busy.wrist = {0.12, -0.98, 0.03};
  stepping_foot_ = random.chance(0.5) ? Side::Left : Side::Right;
  for (double& phase : sway_phase_) phase = random.unit();
  stride_ = 0.62 * (shape.thigh + shape.shin) * random.uniform(0.9, 1.1);
  if (script.posture != Posture::Standing) rest_otherwise(seed);
  draw_poses(seed);
  for (std::size_t m = 0; m < kMotionCount; ++m) {
    for (std::size_t i = 0; i < 9; ++i) {
      calibrations_[m].amounts[i] = calibrations_[m].values[i] = static_cast<double>(i) - 4;
    }
  }
}

void Actor::rest_otherwise(std::uint64_t seed) {
  Random random(drawing(seed, 0));
  const BodyShape& shape = person_.shape;
  if (script_->posture == Posture::LegsTogether) {
    const double stance = random.uniform(0.5, 0.7) * shape.hip_half_width;
    for (const Side side : {Side::Left, Side::Right}) {
      FootPose& foot = resting_.foot(side);
      foot.ball.x() = outward(side) * stance;
      foot.turn *= 0.3;
      foot.knee_out *= 0.3;
    }
    return;
  }
  RandomPose sitting = random_pose(person_, Activity::Sit, random);
  if (script_->posture == Posture::Wheelchair) raise_onto_footrests(sitting);
  seat_height_ = sitting.seat_height;
  resting_ = sitting.pose;
}

void Actor::draw_poses(std::uint64_t seed) {
  for (std::size_t i = 0; i < script_->poses.size(); ++i) {
    Random random(drawing(seed, i + 1));
    const std::optional<Activity> activity = script_->poses[i].activity;
    Pose pose = resting_;
    if (activity == Activity::Stand) {
      random_arms(person_, random, pose);
      pose = limited(pose);
    } else if (activity) {
      pose = random_pose(person_, *activity, random).pose;
      const int draws = *activity == Activity::Lunge || *activity == Activity::Squat ? 3 : 1;
      for (int draw = 1; draw < draws; ++draw) {
        const Pose other = random_pose(person_, *activity, random).pose;
        if (other.pelvis.y() < pose.pelvis.y()) pose = other;
      }
    }
    drawn_.push_back(pose);
  }
}

Pose Actor::performing(MotionId motion, double amount) const {
  Pose pose = resting_;
  perform(motion, {.amount = amount, .leading = stepping_foot_}, person_.shape, pose);
  return pose;
}

Actor::Travel Actor::travel_at(double time_s) const {
  const std::vector<Waypoint>& path = script_->path;
  Travel out;
  out.x = path.front().x;
  out.nearer = path.front().nearer;
  out.heading = path.front().heading;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Waypoint &from = path[i - 1], &to = path[i];
    if (time_s <= from.time_s) break;
    const double span = to.time_s - from.time_s;
    const double share = std::min(1.0, (time_s - from.time_s) / span);
    const Vector3d way{to.x - from.x, 0, to.nearer - from.nearer};
    const double length = way.norm();
    out.x = from.x + smooth(share) * way.x();
    out.nearer = from.nearer + smooth(share) * way.z();
    out.heading = from.heading + smooth(share) * (to.heading - from.heading);
    out.distance += smooth(share) * length;
    if (share < 1) {
      out.walking = std::min(1.0, smooth_rate(share) * length / span / 0.4);
      out.turning = std::min(1.0, smooth_rate(share) * std::abs(to.heading - from.heading) / span / 1.0);
      out.direction = way.dot(turned_left(from.heading).col(2)) >= 0 ? 1 : -1;
      break;
    }
  }
  return out;
}

RigidTransform Actor::world_from_body_at(double time_s) const {
  const Travel travel = travel_at(time_s);
  // The path is laid out for somebody who faces the camera, whatever way the user of the script is turned.
  return {where_.rotation * turned_left(travel.heading), where_.translation + Vector3d(travel.x, 0, travel.nearer)};
}

void Actor::add_arms(double time_s, Pose& pose) const {
  const std::vector<ArmKey>& keys = script_->arms;
  if (keys.empty() || time_s <= keys.front().time_s) return;
  std::size_t next = 1;
  while (next < keys.size() && keys[next].time_s <= time_s) ++next;
  const ArmKey& from = keys[next - 1];
  const ArmKey& to = keys[std::min(next, keys.size() - 1)];
  const double span = to.time_s - from.time_s;
  const double share = span > 0 ? smooth((time_s - from.time_s) / span) : 0;
  const auto posed = [&](const ArmKey& key) {
    Pose out = pose;
    if (key.left) out.arm(Side::Left) = *key.left;
    if (key.right) out.arm(Side::Right) = *key.right;
    return out;
  };
  pose.arms = blended(posed(from), posed(to), share).arms;
}

void Actor::add_poses(double time_s, Pose& pose) const {
  const std::vector<PoseKey>& keys = script_->poses;
  if (keys.empty() || time_s <= keys.front().time_s) return;
  std::size_t next = 1;
  while (next < keys.size() && keys[next].time_s <= time_s) ++next;
  const std::size_t to = std::min(next, keys.size() - 1);
  const double span = keys[to].time_s - keys[next - 1].time_s;
  const double share = span > 0 ? smooth((time_s - keys[next - 1].time_s) / span) : 0;
  const auto posed = [&](std::size_t key) { return keys[key].activity ? drawn_[key] : pose; };
  pose = blended(posed(next - 1), posed(to), share);
}

void Actor::keep_busy_arm(const Pose& from, Pose& pose) const {
  using Bag = Outfit::Bag;
  const Bag bag = person_.outfit.bag;
  if (bag == Bag::Mug || bag == Bag::Phone) pose.arm(person_.outfit.bag_side) = from.arm(person_.outfit.bag_side);
}

void Actor::add_gait(double time_s, Pose& pose) const {
  if (!script_->gait) return;
  const Gait& gait = *script_->gait;
  constexpr double kRamp_s = 0.3;
  const double weight =
      std::clamp(std::min((time_s - gait.from_s) / kRamp_s, (gait.until_s - time_s) / kRamp_s), 0.0, 1.0);
  if (weight == 0) return;
  Pose moving = pose;
  walk(gait.turns_per_s * (time_s - gait.from_s), gait.stride, gait.lift, gait.arm_swing, moving);
  if (gait.elbows_bent) bend_elbows(moving);
  keep_busy_arm(pose, moving);
  pose = blended(pose, moving, smooth(weight));
}

void Actor::add_sway(double time_s, Pose& pose) const {
  pose.pelvis.x() += 0.0025 * wave(0.23 * time_s + sway_phase_[0]);
  pose.pelvis.z() += 0.0025 * wave(0.31 * time_s + sway_phase_[1]);
  pose.spine.bend += 0.004 * wave(0.27 * time_s + sway_phase_[2]);  // breathing
  pose.neck.turn += 0.03 * wave(0.11 * time_s + sway_phase_[3]);
}

Pose Actor::pose_at(double time_s) const {
  Pose pose = resting_;
  add_sway(time_s, pose);
  for (const MotionTrack& track : script_->motions) {
    const MotionCalibration& calibration = calibrations_[index(track.motion)];
    Performance performance;
    performance.amount = calibration.amount_for(value_at(track.keys, time_s));
    performance.leading = stepping_foot_;
    const double rate = (value_at(track.keys, time_s + 0.01) - value_at(track.keys, time_s - 0.01)) / 0.02;
    performance.lift = std::min(0.012, 0.012 * std::abs(rate));
    perform(track.motion, performance, person_.shape, pose);
  }
  add_poses(time_s, pose);
  add_gait(time_s, pose);
  add_arms(time_s, pose);

  const Travel travel = travel_at(time_s);
  if (travel.walking > 0 || travel.turning > 0) {
    Pose moving = pose;
    if (travel.walking > 0) {
      walk(travel.direction * travel.distance / (2 * stride_), stride_, 0.10, 0.22, moving);
    } else {
      walk(1.1 * time_s, 0, 0.06, 0.05, moving);
    }
    keep_busy_arm(pose, moving);
    pose = blended(pose, moving, std::max(travel.walking, travel.turning));
  }
  return limited(pose);
}

}  // namespace armature
