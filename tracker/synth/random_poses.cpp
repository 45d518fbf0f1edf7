#include "tracker/synth/random_poses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tracker/body/rotation.h"
#include "tracker/synth/motion_poses.h"

namespace armature {
namespace {

using Eigen::Vector3d;

constexpr double kTurn = 2 * std::numbers::pi;
double cosine(double turns) {
  return on_grid(std::cos(kTurn * turns));
}
double sine(double turns) {
  return on_grid(std::sin(kTurn * turns));
}

constexpr std::array<Side, 2> kSides = {Side::Left, Side::Right};

/// Arms that hang; nearly flush with the body more often than not.
ArmPose hanging(Random& random) {
  ArmPose arm;
  const double away = random.chance(0.6) ? random.uniform(-0.01, 0.12) : random.uniform(0.1, 0.4);
  arm.wrist = {away, -random.uniform(0.93, 0.99), random.uniform(-0.08, 0.2)};
  arm.elbow_swivel = random.uniform(-0.3, 0.6);
  return arm;
}

ArmPose anywhere(Random& random) {
  ArmPose arm;
  // A direction in the part of the sphere that arms reach: forward, outward, up, down, across the chest.
  Vector3d direction;
  do {
    direction = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
  } while (direction.squaredNorm() > 1 || direction.squaredNorm() < 0.05 || direction.z() < -0.35 ||
           (direction.x() < -0.6 * direction.norm()));
  direction.normalize();
  const double nearest = direction.x() < 0 ? 0.45 : 0.35;
  arm.wrist = random.uniform(nearest, 0.99) * direction;
  arm.elbow_swivel = random.uniform(-0.7, 0.9);
  arm.wrist_flex = random.uniform(-0.5, 0.9);
  arm.hangs = random.uniform(0, 0.6);
  return arm;
}

/// Named places for a hand, in arm lengths from the shoulder (outward, up, forward).
enum class Habit { Hip, Chest, Crossed, Face, Ear, Mug, Raised, Ahead, Sideways, Pocket, Wave };
constexpr int kHabitCount = 11;

ArmPose habitual(Habit habit, Random& random) {
  ArmPose arm;
  arm.hangs = 0.2;
  const auto about = [&](double out, double up, double forward, double spread) {
    arm.wrist = {out + spread * random.normal(), up + spread * random.normal(), forward + spread * random.normal()};
  };
  switch (habit) {
    case Habit::Hip:
      about(0.05, -0.66, 0.08, 0.04);
      arm.elbow_swivel = random.uniform(0.6, 1.2);
      arm.wrist_flex = 0.6;
      break;
    case Habit::Chest: about(-0.15, -0.30, 0.38, 0.07); break;
    case Habit::Crossed:
      about(-0.40, -0.36, 0.30, 0.04);
      arm.elbow_swivel = random.uniform(0.1, 0.5);
      break;
    case Habit::Face: about(-0.18, 0.22, 0.38, 0.06); break;
    case Habit::Ear:
      about(-0.02, 0.26, 0.20, 0.04);
      arm.elbow_swivel = random.uniform(0.0, 0.8);
      break;
    case Habit::Mug: about(-0.05, -0.28, 0.52, 0.07); break;
    case Habit::Raised: about(0.15, 0.92, 0.12, 0.12); break;
    case Habit::Ahead: about(-0.05, 0.0, 0.93, 0.12); break;
    case Habit::Sideways: about(0.95, 0.0, 0.1, 0.12); break;
    case Habit::Pocket:
      about(0.08, -0.85, 0.05, 0.03);
      arm.elbow_swivel = random.uniform(0.2, 0.8);
      break;
    case Habit::Wave:
      about(0.45, 0.42, 0.25, 0.12);
      arm.elbow_swivel = random.uniform(0.2, 0.8);
      break;
  }
  return arm;
}

void random_stance(const BodyShape& shape, Random& random, Pose& pose) {
  // Legs close together as often as apart.
  const double stance = random.chance(0.45) ? random.uniform(0.55, 1.0) : random.uniform(1.0, 2.2);
  pose = standing_pose(shape, stance, random.uniform(0.001, 0.012));
  for (const Side side : kSides) {
    FootPose& foot = pose.foot(side);
    foot.turn = outward(side) * random.uniform(-0.05, 0.4);
    foot.ball += Vector3d(0, 0, random.uniform(-0.06, 0.06));
  }
  // Weight on one leg.
  pose.pelvis.x() += 0.03 * random.normal();
  pose.pelvis_turns.lean += 0.03 * random.normal();
}

/// Every motion, about half of them far. What is learned from poses is an estimate that leans towards the frequent
/// ones: were a motion mostly absent here, small ones would come out too small, and large ones less so.
void steer(const BodyShape& shape, Random& random, Pose& pose) {
  for (std::size_t m = 0; m < kMotionCount; ++m) {
    const auto motion = static_cast<MotionId>(m);
    if (motion == MotionId::RotateBust) continue;  // both rotations
    Performance performance;
    performance.amount = random.chance(0.4) ? random.uniform(-0.65, 0.65) : 0.12 * random.normal();
    if (motion == MotionId::TranslateHips) performance.amount *= 0.6;
    if (motion == MotionId::Step) performance.amount *= random.chance(0.5) ? 1.3 : 0;
    performance.leading = random.chance(0.5) ? Side::Left : Side::Right;
    performance.lift = random.chance(0.3) ? random.uniform(0, 0.08) : 0;
    perform(motion, performance, shape, pose);
  }
}

void lunge(const BodyShape& shape, Random& random, Pose& pose) {
  const Side front = random.chance(0.5) ? Side::Left : Side::Right;
  const Side rear = front == Side::Left ? Side::Right : Side::Left;
  const double leg = shape.thigh + shape.shin;
  const double depth = random.uniform(0, 1);
  const double length = leg * random.uniform(0.55, 1.0);
  pose.foot(front).ball.z() += 0.55 * length;
  pose.foot(rear).ball.z() -= 0.45 * length;
  pose.foot(rear).pitch = random.uniform(0.5, 1.1);
  pose.pelvis.y() = shape.ankle_height + leg * (0.93 - 0.42 * depth);
  pose.pelvis.z() = random.uniform(-0.05, 0.1);
  pose.spine.bend += random.uniform(-0.1, 0.4);
}

void squat(const BodyShape& shape, Random& random, Pose& pose) {
  const double leg = shape.thigh + shape.shin;
  const double depth = random.uniform(0.05, 1);
  pose.pelvis.y() = shape.ankle_height + leg * (0.98 - 0.60 * depth);
  pose.pelvis.z() -= leg * 0.22 * depth;
  pose.pelvis_turns.bend = 0.5 * depth;
  pose.spine.bend += random.uniform(0, 0.5) * depth;
  pose.neck.bend -= random.uniform(0.2, 0.7) * depth;
  for (const Side side : kSides) {
    pose.foot(side).ball.x() *= random.uniform(1.0, 1.5);
    pose.foot(side).knee_out = random.uniform(0, 0.5);
  }
}

double sit(const BodyShape& shape, Random& random, Pose& pose) {
  const double seat = std::min(random.uniform(0.40, 0.52), shape.shin + shape.ankle_height + 0.03);
  const double seat_to_hip = 0.085 * shape.bulk;
  pose.pelvis = {0, seat + seat_to_hip, 0};
  pose.pelvis_turns.bend = random.uniform(-0.35, 0.1);
  pose.spine.bend = random.uniform(-0.15, 0.5);
  const double apart = random.uniform(0.6, 2.2);
  for (const Side side : kSides) {
    FootPose& foot = pose.foot(side);
    foot.ball = {outward(side) * apart * shape.hip_half_width, 0,
                 shape.thigh + shape.foot + random.uniform(-0.15, 0.12)};
    foot.turn = outward(side) * random.uniform(-0.1, 0.4);
  }
  return seat;
}

/// What real people's trunks do that no activity asks for: hips turn and list with whatever legs do, also against them,
/// and shoulders follow the arm that reaches. Were it absent, hips would be read from the legs and shoulders from the
/// chest.
void loosen_trunk(Activity activity, Random& random, Pose& pose) {
  if (activity == Activity::Walk || activity == Activity::Jog) pose.pelvis_turns.turn *= random.uniform(-1, 1);
  pose.pelvis_turns.turn += 0.10 * random.normal();
  pose.pelvis_turns.lean += 0.03 * random.normal();
  for (const Side side : kSides) {
    const Vector3d wrist = pose.arm(side).wrist;
    const double forward = std::clamp(wrist.z(), -0.3, 0.8) - std::min(0.0, 0.5 * wrist.x());
    pose.reach[static_cast<std::size_t>(side)] = 0.06 * random.unit() * forward + 0.012 * random.normal();
  }
}

}  // namespace

void walk(double phase, double stride, double lift, double arm_swing, Pose& pose) {
  for (const Side side : kSides) {
    FootPose& foot = pose.foot(side);
    const double own = phase + (side == Side::Left ? 0.5 : 0.0);
    const double turns = own - std::floor(own);
    // On the floor for the first half: it travels backward under the body; in the air for the second.
    if (turns < 0.5) {
      foot.ball.z() += stride * (0.5 - 2 * turns);
      foot.pitch = turns > 0.35 ? (turns - 0.35) * 2.5 * std::min(1.0, stride / 0.4) : 0.0;
    } else {
      const double swing = 2 * turns - 1;
      const double eased = swing * swing * (3 - 2 * swing);
      foot.ball.z() += stride * (eased - 0.5);
      foot.ball.y() += lift * sine(0.5 * swing);
      foot.pitch = (0.37 * std::min(1.0, stride / 0.4) + 1.5 * lift) * cosine(0.25 * swing);
    }
    ArmPose& arm = pose.arm(side);
    const double swung = -arm_swing * cosine(own);
    arm.wrist = {0.14, -0.94, 0.10 + swung};
    arm.wrist *= (0.97 - 0.10 * std::max(0.0, swung)) / arm.wrist.norm();
    arm.elbow_swivel = 0;
  }
  pose.pelvis.y() -= 0.10 * stride * stride;
  pose.pelvis_turns.turn -= 0.15 * std::min(1.0, stride) * cosine(phase);
  pose.spine.turn += 0.25 * std::min(1.0, stride) * cosine(phase);
}

void raise_onto_footrests(RandomPose& sitting) {
  constexpr double kFootrest_m = 0.10;
  sitting.seat_height += kFootrest_m;
  sitting.pose.pelvis.y() += kFootrest_m;
  for (FootPose& foot : sitting.pose.feet) foot.ball.y() += kFootrest_m;
}

void bend_elbows(Pose& pose) {
  for (ArmPose& arm : pose.arms) {
    arm.wrist = {0.05, -0.45 + 0.3 * std::abs(arm.wrist.z()), 0.30 + 0.6 * arm.wrist.z()};
  }
}

void random_arms(const Person& person, Random& random, Pose& pose) {
  const bool together = random.chance(0.35);
  ArmPose shared;
  for (const Side side : kSides) {
    ArmPose arm;
    const double kind = random.unit();
    if (kind < 0.38) {
      arm = hanging(random);
    } else if (kind < 0.70) {
      arm = habitual(static_cast<Habit>(random.below(kHabitCount)), random);
    } else {
      arm = anywhere(random);
    }
    if (side == Side::Left) shared = arm;
    if (side == Side::Right && together) {
      arm = shared;
      for (const int axis : {2, 1, 0}) arm.wrist[axis] += 0.04 * random.normal();
    }
    pose.arm(side) = arm;
    pose.shrug[static_cast<std::size_t>(side)] = 0.008 * random.normal();
  }
  using Bag = Outfit::Bag;
  const Bag bag = person.outfit.bag;
  ArmPose& busy = pose.arm(person.outfit.bag_side);
  if (bag == Bag::Mug) busy = habitual(Habit::Mug, random);
  if (bag == Bag::Phone) busy = habitual(random.chance(0.6) ? Habit::Ear : Habit::Chest, random);
  if (bag == Bag::Hand) {
    busy = hanging(random);
    busy.wrist.x() = std::max(busy.wrist.x(), 0.08);
  }
}

RandomPose random_pose(const Person& person, Activity activity, Random& random) {
  const BodyShape& shape = person.shape;
  RandomPose out;
  out.activity = activity;
  Pose& pose = out.pose;
  random_stance(shape, random, pose);
  pose.spine = {0.08 * random.normal(), 0.06 * random.normal(), 0.04 * random.normal()};
  pose.neck = {0.35 * random.normal(), 0.18 * random.normal(), 0.10 * random.normal()};
  bool arms_done = false;
  switch (activity) {
    case Activity::Stand: break;
    case Activity::Steer: steer(shape, random, pose); break;
    case Activity::Walk: {
      const double arm_swing = random.uniform(0, 0.4), lift = random.uniform(0.05, 0.35);
      const double stride = random.chance(0.3) ? 0.0 : random.uniform(0.2, 0.75);
      walk(random.unit(), stride, lift, arm_swing, pose);
      arms_done = random.chance(0.5);
      break;
    }
    case Activity::Jog: {
      const double arm_swing = random.uniform(0.2, 0.5), lift = random.uniform(0.15, 0.5);
      const double stride = random.uniform(0, 0.6);
      walk(random.unit(), stride, lift, arm_swing, pose);
      bend_elbows(pose);
      arms_done = random.chance(0.8);
      break;
    }
    case Activity::Lunge: lunge(shape, random, pose); break;
    case Activity::Squat: squat(shape, random, pose); break;
    case Activity::Sit: out.seat_height = sit(shape, random, pose); break;
    case Activity::Reach:
      pose.spine.bend += random.uniform(-0.2, 0.9);
      pose.spine.turn += random.uniform(-0.6, 0.6);
      pose.spine.lean += random.uniform(-0.3, 0.3);
      for (ArmPose& arm : pose.arms) arm = anywhere(random);
      arms_done = random.chance(0.6);
      break;
  }
  if (!arms_done) random_arms(person, random, pose);
  if (activity == Activity::Sit && random.chance(0.5)) {  // hands on the thighs
    for (ArmPose& arm : pose.arms) {
      arm.wrist = {0.02 + 0.05 * random.normal(), -0.66 + 0.06 * random.normal(), 0.5 + 0.08 * random.normal()};
      arm.hangs = 1;
    }
  }
  pose = limited(pose);
  return out;
}

RandomPose random_pose(const Person& person, Random& random) {
  struct Share {
    double until;
    Activity activity;
  };
  constexpr std::array<Share, 8> kShares = {{{0.12, Activity::Stand},
                                             {0.52, Activity::Steer},
                                             {0.62, Activity::Walk},
                                             {0.70, Activity::Jog},
                                             {0.78, Activity::Lunge},
                                             {0.86, Activity::Squat},
                                             {0.93, Activity::Sit},
                                             {1.00, Activity::Reach}}};
  const double draw = random.unit();
  for (const Share& share : kShares) {
    if (draw >= share.until) continue;
    RandomPose out = random_pose(person, share.activity, random);
    loosen_trunk(share.activity, random, out.pose);
    return out;
  }
  return random_pose(person, Activity::Stand, random);
}

}  // namespace armature
