#include "tracker/body/kinematics.h"

#include <random>

#include <gtest/gtest.h>

#include "tracker/body/rotation.h"

namespace armature {
namespace {

using Eigen::Vector3d;

constexpr double kMicrometre = 1e-6;

/// A pose from a fixed seed with every number away from its rest.
Pose some_pose(const BodyShape& shape, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(-1, 1);
  Pose pose = standing_pose(shape);
  pose.pelvis += 0.1 * Vector3d(any(random), any(random) - 1, any(random));
  pose.pelvis_turns = {0.5 * any(random), 0.3 * any(random), 0.2 * any(random)};
  pose.spine = {0.5 * any(random), 0.4 * any(random), 0.3 * any(random)};
  pose.twist = 0.5 * any(random);
  pose.neck = {0.5 * any(random), 0.4 * any(random), 0.3 * any(random)};
  for (ArmPose& arm : pose.arms) {
    arm.wrist = {any(random), any(random), any(random)};
    arm.elbow_swivel = any(random);
    arm.wrist_flex = any(random);
  }
  for (FootPose& foot : pose.feet) {
    foot.ball += 0.1 * Vector3d(any(random), 0, any(random));
    foot.turn += 0.3 * any(random);
    foot.pitch = 0.4 * any(random);
    foot.knee_out = 0.2 * any(random);
  }
  return limited(pose);
}

double distance(const PosedBody& body, JointId a, JointId b) {
  return (body[a] - body[b]).norm();
}

TEST(Kinematics, BonesKeepTheirLengthInEveryPose) {
  for (const double stature : {1.2, 1.75, 2.0}) {
    const BodyShape shape = average_shape(stature);
    for (unsigned seed = 0; seed < 100; ++seed) {
      const PosedBody body = pose_body(shape, some_pose(shape, seed));
      for (const Side side : {Side::Left, Side::Right}) {
        const auto at = [&](JointId left) { return on_side(left, side); };
        EXPECT_NEAR(distance(body, at(JointId::LeftHip), at(JointId::LeftKnee)), shape.thigh, kMicrometre);
        EXPECT_NEAR(distance(body, at(JointId::LeftKnee), at(JointId::LeftAnkle)), shape.shin, kMicrometre);
        EXPECT_NEAR(distance(body, at(JointId::LeftShoulder), at(JointId::LeftElbow)), shape.upper_arm, kMicrometre);
        EXPECT_NEAR(distance(body, at(JointId::LeftElbow), at(JointId::LeftWrist)), shape.forearm, kMicrometre);
      }
      EXPECT_NEAR(distance(body, JointId::LeftHip, JointId::RightHip), 2 * shape.hip_half_width, kMicrometre);
    }
  }
}

TEST(Kinematics, AMirroredPoseGivesMirroredJoints) {
  const BodyShape shape = average_shape(1.7);
  for (unsigned seed = 0; seed < 50; ++seed) {
    const Pose pose = some_pose(shape, seed);
    const PosedBody body = pose_body(shape, pose);
    const PosedBody reflected = pose_body(shape, mirrored(pose));
    for (int j = 0; j < kJointCount; ++j) {
      const auto joint = static_cast<JointId>(j);
      Vector3d expected = body[joint];
      expected.x() = -expected.x();
      EXPECT_LT((reflected[mirrored(joint)] - expected).norm(), kMicrometre)
          << kJointNames[index(joint)] << " " << seed;
    }
  }
}

TEST(Kinematics, PlantedFeetStayPlantedWhileThePelvisMoves) {
  const BodyShape shape = average_shape(1.75);
  const Pose standing = standing_pose(shape);
  const PosedBody rest = pose_body(shape, standing);
  for (const Vector3d& moved :
       {Vector3d(0.1, 0, 0), Vector3d(-0.1, -0.1, 0), Vector3d(0, -0.3, -0.1), Vector3d(0, 0.2, 0)}) {
    Pose pose = standing;
    pose.pelvis += moved;
    const PosedBody body = pose_body(shape, pose);
    for (const JointId joint : {JointId::LeftAnkle, JointId::RightAnkle, JointId::LeftFoot, JointId::RightFoot}) {
      EXPECT_LT((body[joint] - rest[joint]).norm(), 1e-4) << kJointNames[index(joint)];
    }
  }
}

TEST(Kinematics, ThePelvisSinksUntilTheFeetAreReached) {
  const BodyShape shape = average_shape(1.75);
  Pose pose = standing_pose(shape);
  pose.foot(Side::Left).ball.z() += 0.4;
  pose.foot(Side::Right).ball.z() -= 0.4;
  const PosedBody body = pose_body(shape, pose);
  EXPECT_LT(body.pelvis_centre.y(), pose.pelvis.y() - 0.05);
  EXPECT_NEAR(body[JointId::LeftAnkle].z(), 0.4, 0.02);
}

TEST(Kinematics, AStandingBodyHasItsStature) {
  for (const double stature : {1.2, 1.5, 1.75, 2.0}) {
    const BodyShape shape = average_shape(stature);
    const PosedBody body = pose_body(shape, standing_pose(shape, 1.0, 0));
    EXPECT_NEAR(body[JointId::HeadTop].y(), stature, 0.01);
    EXPECT_GT(body[JointId::LeftShoulder].x(), body[JointId::RightShoulder].x()) << "left is the person's own: +x";
  }
}

TEST(Kinematics, PositiveTurnsAreToTheLeftAndForward) {
  const BodyShape shape = average_shape(1.75);
  const Vector3d rest = pose_body(shape, standing_pose(shape))[JointId::Neck];
  const auto neck_of = [&](auto&& change) -> Vector3d {
    Pose pose = standing_pose(shape);
    change(pose);
    return pose_body(shape, pose)[JointId::Neck] - rest;
  };
  EXPECT_GT(neck_of([](Pose& p) { p.spine.lean = 0.3; }).x(), 0.05);
  EXPECT_GT(neck_of([](Pose& p) { p.spine.bend = 0.3; }).z(), 0.05);
  Pose turned = standing_pose(shape);
  turned.twist = 0.3;
  const PosedBody body = pose_body(shape, turned);
  EXPECT_LT(body[JointId::LeftShoulder].z(), body[JointId::RightShoulder].z()) << "counter-clockwise from above";
}

TEST(Kinematics, AShoulderDrawnForwardTakesItsArmAlong) {
  const BodyShape shape = average_shape(1.75);
  Pose pose = standing_pose(shape);
  const PosedBody before = pose_body(shape, pose);
  pose.reach[static_cast<std::size_t>(Side::Left)] = 0.05;
  const PosedBody after = pose_body(shape, pose);
  for (const JointId joint : {JointId::LeftShoulder, JointId::LeftElbow, JointId::LeftWrist}) {
    EXPECT_NEAR(after[joint].z() - before[joint].z(), 0.05, 1e-6) << kJointNames[index(joint)];
  }
  EXPECT_EQ(after[JointId::RightShoulder], before[JointId::RightShoulder]);
}

TEST(Kinematics, LimitsHoldWhatPeopleCannotDo) {
  Pose wild = standing_pose(average_shape(1.75));
  wild.spine = {9, -9, 9};
  wild.arm(Side::Left).wrist = {5, 5, 5};
  wild.arm(Side::Right).wrist = {0, 0, 0};
  const PoseLimits limits;
  const Pose held = limited(wild, limits);
  EXPECT_EQ(held.spine.turn, limits.spine.turn);
  EXPECT_EQ(held.spine.bend, kSpineBackward);
  EXPECT_NEAR(held.arm(Side::Left).wrist.norm(), limits.reach_max, 1e-12);
  EXPECT_NEAR(held.arm(Side::Right).wrist.norm(), limits.reach_min, 1e-12);
}

}  // namespace
}  // namespace armature
