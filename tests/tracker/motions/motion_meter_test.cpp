#include "tracker/motions/motion_meter.h"

#include <gtest/gtest.h>

#include "tests/tracker/motions/standing_person.h"

namespace armature {
namespace {

using namespace std::chrono_literals;
using enum JointId;
using enum MotionId;

constexpr float kTolerance = 1e-4F;  // radians

/// Turns her shoulders by 0.4, which draws the hips along by a quarter of it, and the hips by 0.2 herself.
Skeleton turned_person(const Skeleton& standing) {
  Skeleton person = standing;
  test::turn(person, {LeftShoulder, RightShoulder}, person[Neck].position, 0.4F);
  test::turn(person, {LeftHip, RightHip}, person[Waist].position, 0.2F + 0.25F * 0.4F);
  return person;
}

TEST(MotionMeter, TakesOffTheHipsWhatOtherMotionsDrawThemAlong) {
  const Skeleton standing = test::standing_person();
  MotionOptions options = of_true_joints({});
  options.read_as_hips[index(RotateShoulders)] = 0.25F;
  MotionMeter meter(options);
  const auto& readings = meter.measure(turned_person(standing), test::resting(standing), 33ms);
  EXPECT_NEAR(readings[index(RotateHips)].angle_rad, 0.2F, kTolerance);
  EXPECT_NEAR(readings[index(RotateShoulders)].angle_rad, 0.4F, kTolerance);
}

TEST(MotionMeter, TakesNothingOffForWhatCannotBeSeen) {
  const Skeleton standing = test::standing_person();
  MotionOptions options = of_true_joints({});
  options.read_as_hips[index(RotateShoulders)] = 0.25F;
  MotionMeter meter(options);
  Skeleton person = turned_person(standing);
  person[LeftShoulder].confidence = 0.1F;
  EXPECT_NEAR(meter.measure(person, test::resting(standing), 33ms)[index(RotateHips)].angle_rad, 0.3F, kTolerance);
}

TEST(MotionMeter, HoldsWhatIsTakenOffAsLongAsTheMotion) {
  const Skeleton standing = test::standing_person();
  MotionOptions options = of_true_joints({});
  options.read_as_hips[index(RotateShoulders)] = 0.25F;
  MotionMeter meter(options);
  Skeleton person = turned_person(standing);
  meter.measure(person, test::resting(standing), 33ms);
  person[LeftShoulder].confidence = 0.1F;
  const auto& readings = meter.measure(person, test::resting(standing), 33ms);
  EXPECT_NEAR(readings[index(RotateHips)].angle_rad, 0.2F, kTolerance) << "no jump";
  meter.measure(person, test::resting(standing), options.hold_time);
  const auto& later = meter.measure(person, test::resting(standing), 10s);
  EXPECT_NEAR(later[index(RotateHips)].angle_rad, 0.3F, 0.01F) << "it is not held any more";
}

}  // namespace
}  // namespace armature
