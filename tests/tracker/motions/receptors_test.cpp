#include "tracker/motions/receptors.h"

#include <gtest/gtest.h>

#include "tests/tracker/motions/standing_person.h"
#include "tracker/motions/motion_options.h"

namespace armature {
namespace {

using Eigen::Vector3f;
using test::resting;
using test::standing_person;
using enum JointId;

constexpr float kTolerance = 1e-4F;  // radians

float angle_of(MotionId motion, const Skeleton& now, const RestPose& rest) {
  return motion_angles(now, rest).angle_rad[index(motion)];
}

TEST(UserFrame, OfSomebodyWhoFacesTheCameraIsTheCamerasTurnedRound) {
  const UserFrame frame = resting(standing_person()).frame;
  EXPECT_TRUE(frame.up.isApprox(Vector3f(0, -1, 0)));
  EXPECT_TRUE(frame.left.isApprox(Vector3f(1, 0, 0)));
  EXPECT_TRUE(frame.forward.isApprox(Vector3f(0, 0, -1)));
}

TEST(UserFrame, OfCoincidingHipsIsStillAFrame) {
  Skeleton person = standing_person();
  person[LeftHip].position = person[RightHip].position;
  const UserFrame frame = user_frame(person, -Vector3f::UnitY());
  EXPECT_NEAR(frame.left.cross(frame.up).dot(frame.forward), 1, kTolerance);
}

TEST(MotionAngles, AreZeroInTheRestPose) {
  const Skeleton person = standing_person();
  for (const float angle : motion_angles(person, resting(person)).angle_rad) EXPECT_NEAR(angle, 0, kTolerance);
}

TEST(MotionAngles, TurningShouldersToTheLeftIsPositive) {
  const RestPose rest = resting(standing_person());
  Skeleton now = rest.skeleton;
  test::turn(now, {LeftShoulder, RightShoulder}, now[Neck].position, radians(20));
  EXPECT_GT(now[LeftShoulder].position.z(), rest.skeleton[LeftShoulder].position.z()) << "the left one goes back";
  EXPECT_NEAR(angle_of(MotionId::RotateShoulders, now, rest), radians(20), kTolerance);
  EXPECT_NEAR(angle_of(MotionId::RotateHips, now, rest), 0, kTolerance);
  EXPECT_NEAR(angle_of(MotionId::RotateBust, now, rest), radians(10), kTolerance);
}

TEST(MotionAngles, RotateBustTrustsWhatIsSeenBetter) {
  const RestPose rest = resting(standing_person());
  Skeleton now = rest.skeleton;
  test::turn(now, {LeftShoulder, RightShoulder}, now[Neck].position, radians(20));
  now[LeftHip].confidence = 0.25F;
  EXPECT_NEAR(angle_of(MotionId::RotateBust, now, rest), radians(16), kTolerance);
  EXPECT_FLOAT_EQ(motion_angles(now, rest).confidence[index(MotionId::RotateHips)], 0.25F);
}

TEST(MotionAngles, WhatWasNotSeenAtRestHasNotMovedFromAnywhere) {
  Skeleton at_rest = standing_person();
  at_rest[RightKnee].confidence = 0.4F;
  const RestPose rest = resting(at_rest);
  const MotionAngles angles = motion_angles(standing_person(), rest);
  EXPECT_FLOAT_EQ(angles.confidence[index(MotionId::BendKnees)], 0.4F);
  EXPECT_FLOAT_EQ(angles.confidence[index(MotionId::RotateShoulders)], 1.0F);
}

TEST(MotionAngles, TurningHipsToTheRightIsNegative) {
  const RestPose rest = resting(standing_person());
  Skeleton now = rest.skeleton;
  test::turn(now, {LeftHip, RightHip}, now[Waist].position, radians(-15));
  EXPECT_NEAR(angle_of(MotionId::RotateHips, now, rest), radians(-15), kTolerance);
}

TEST(MotionAngles, LeaningLeftAndBendingForwardArePositive) {
  const RestPose rest = resting(standing_person());
  Skeleton leaning = rest.skeleton;
  const float spine = (rest.skeleton[Neck].position - rest.skeleton[Waist].position).norm();
  leaning[Neck].position = leaning[Waist].position + spine * Vector3f(std::sin(0.3F), -std::cos(0.3F), 0);
  EXPECT_NEAR(angle_of(MotionId::LeanBust, leaning, rest), 0.3F, kTolerance);

  Skeleton bending = rest.skeleton;
  bending[Head].position.z() -= 0.2F;
  EXPECT_GT(angle_of(MotionId::BendBust, bending, rest), 0.3F);
}

TEST(MotionAngles, ThoseOfSomebodyTurnedBy45DegreesAreMeasuredInHerFrame) {
  Skeleton person = standing_person();
  const Vector3f about = person[Waist].position;
  const auto turn_all = [&](Skeleton& s) {
    for (std::size_t j = 0; j < kJointCount; ++j) test::turn(s, {static_cast<JointId>(j)}, about, radians(45));
    const Eigen::Matrix3f r = Eigen::AngleAxisf(-radians(45), Vector3f::UnitY()).matrix();
    s.user_position = about + r * (s.user_position - about);
  };
  Skeleton bending = person;
  bending[Head].position.z() -= 0.2F;
  bending[Neck].position.z() -= 0.15F;
  const float expected = angle_of(MotionId::BendBust, bending, resting(person));
  turn_all(person), turn_all(bending);
  EXPECT_NEAR(angle_of(MotionId::BendBust, bending, resting(person)), expected, kTolerance);
  EXPECT_NEAR(angle_of(MotionId::LeanBust, bending, resting(person)), 0, kTolerance) << "not steered by bending";
}

TEST(MotionAngles, TranslatingHipsIsMeasuredAgainstTheFeetAndNotAgainstTheBody) {
  const RestPose rest = resting(standing_person());
  Skeleton now = rest.skeleton;
  for (const JointId joint : {LeftHip, RightHip, Waist, Neck, Head}) now[joint].position.x() += 0.06F;
  now.user_position.x() += 0.06F;  // P follows the hips; the receptor must not
  EXPECT_GT(angle_of(MotionId::TranslateHips, now, rest), radians(8));

  Skeleton sidestep = rest.skeleton;
  for (Joint& joint : sidestep.joints) joint.position.x() += 0.06F;
  EXPECT_NEAR(angle_of(MotionId::TranslateHips, sidestep, rest), 0, kTolerance);
}

TEST(MotionAngles, TheRightKneeForwardIsPositiveAndAStepKnowsItsDirection) {
  const RestPose rest = resting(standing_person());
  Skeleton forward = rest.skeleton;
  forward[RightKnee].position.z() -= 0.12F;
  const float yaw = angle_of(MotionId::BendKnees, forward, rest);
  EXPECT_NEAR(yaw, std::atan2(0.12F, 0.26F), kTolerance);
  EXPECT_NEAR(angle_of(MotionId::Step, forward, rest), yaw, kTolerance) << "forward, whichever foot";

  Skeleton backward = rest.skeleton;
  backward[RightKnee].position.z() += 0.12F;
  EXPECT_NEAR(angle_of(MotionId::Step, backward, rest), -yaw, kTolerance);
  EXPECT_NEAR(angle_of(MotionId::BendKnees, backward, rest), -yaw, kTolerance);
}

TEST(MotionAngles, StayFiniteForASkeletonCollapsedToAPoint) {
  const RestPose rest = resting(standing_person());
  for (const float angle : motion_angles(Skeleton{}, rest).angle_rad) EXPECT_TRUE(std::isfinite(angle));
}

}  // namespace
}  // namespace armature
