#include <gtest/gtest.h>

#include "tracker/transfer/actuator.h"
#include "tracker/transfer/steering_pair.h"
#include "tracker/transfer/transfer_function.h"

namespace armature {
namespace {

using namespace std::chrono_literals;

TEST(Transfer, IsZeroInTheDeadZoneAndOneAtTheRangesEnd) {
  EXPECT_EQ(transfer(0.19F, 0.2F, 2), 0);
  EXPECT_EQ(transfer(0.2F, 0.2F, 2), 0);
  EXPECT_NEAR(transfer(0.6F, 0.2F, 2), 0.25F, 1e-6F);
  EXPECT_EQ(transfer(1, 0.2F, 2), 1);
}

TEST(ShapedMotion, EntersAtAlphaAndLeavesAtSevenTenthsOfIt) {
  ShapedMotion motion;
  EXPECT_EQ(motion.shape(0.19F, 0.2F, 1), 0);
  EXPECT_GT(motion.shape(0.21F, 0.2F, 1), 0);
  EXPECT_GT(motion.shape(0.16F, 0.2F, 1), 0) << "still active";
  EXPECT_EQ(motion.shape(0.13F, 0.2F, 1), 0);
  EXPECT_EQ(motion.shape(0.16F, 0.2F, 1), 0) << "has to enter again";
}

TEST(ShapedMotion, IsSymmetricAndDoesNotCarryActivityAcrossZero) {
  ShapedMotion left, right;
  EXPECT_FLOAT_EQ(left.shape(0.5F, 0.2F, 1), -right.shape(-0.5F, 0.2F, 1));
  EXPECT_EQ(left.shape(-0.16F, 0.2F, 1), 0);
}

TEST(ShapedMotion, DoesNotSteerWhereNoiseAsksForTooWideADeadZone) {
  EXPECT_FLOAT_EQ(dead_zone(0.2F, 0.03F), 0.2F);
  EXPECT_FLOAT_EQ(dead_zone(0.2F, 0.08F), 0.32F);
  ShapedMotion motion;
  EXPECT_EQ(motion.shape(1, dead_zone(0.2F, 0.12F), 1), 0);
}

TEST(Actuator, LimitsAccelerationButNeitherSlowingDownNorStopping) {
  Actuator actuator(
      {.max_walk_m_s = 1, .max_turn_rad_s = 1, .walk_acceleration_m_s2 = 2, .turn_acceleration_rad_s2 = 4});
  EXPECT_NEAR(actuator.drive(1, 0, 100ms).linear_m_s, 0.2F, 1e-6F);
  EXPECT_NEAR(actuator.drive(1, -1, 100ms).linear_m_s, 0.4F, 1e-6F);
  EXPECT_NEAR(actuator.drive(1, -1, 100ms).angular_rad_s, -0.8F, 1e-6F);
  EXPECT_NEAR(actuator.drive(0.1F, -1, 100ms).linear_m_s, 0.1F, 1e-6F);
  EXPECT_EQ(actuator.drive(0, 0, 1ms).angular_rad_s, 0);
  (void)actuator.drive(1, 1, 1s);
  EXPECT_NEAR(actuator.drive(-1, 1, 100ms).linear_m_s, -0.2F, 1e-6F) << "reversing starts from a stop";
  EXPECT_EQ(actuator.stop().linear_m_s, 0);
}

TEST(SteeringPair, ThirtySixOfTheFortyTwoPairsOfTheSevenMotionsAreUncorrelated) {
  int allowed = 0, with_permission = 0;
  for (int turn = 0; turn < kMotionCount; ++turn) {
    for (int walk = 0; walk < kMotionCount; ++walk) {
      const SteeringPair pair{static_cast<MotionId>(turn), static_cast<MotionId>(walk)};
      if (pair.turn == MotionId::RotateBust || pair.walk == MotionId::RotateBust) continue;
      allowed += !refused(pair, false);
      with_permission += !refused(pair, true);
    }
  }
  EXPECT_EQ(allowed, 36);
  EXPECT_EQ(with_permission, 42);
}

TEST(SteeringPair, ARefusalSaysWhichMotionsAndWhatToDo) {
  const auto why = refused({MotionId::LeanBust, MotionId::BendBust}, false);
  ASSERT_TRUE(why);
  EXPECT_NE(why->find("lean_bust"), std::string::npos);
  EXPECT_NE(why->find("allow_correlated"), std::string::npos);
}

}  // namespace
}  // namespace armature
