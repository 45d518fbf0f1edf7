#include "tracker/engagement/engagement.h"

#include <vector>

#include <gtest/gtest.h>

namespace armature {
namespace {

using namespace std::chrono_literals;

User at(std::uint8_t id, float x, float z) {
  return {.id = id, .pixel_count = 5000, .centre = {x, 0, z}};
}

TEST(Engagement, GoesFromAbsentOverCalibratingToEngaged) {
  Engagement engagement{{}};
  EXPECT_EQ(engagement.choose({}, 0s), 0);
  EXPECT_EQ(engagement.update(false, false), EngagementState::Absent);
  const std::vector<User> users = {at(3, 0, 2)};
  EXPECT_EQ(engagement.choose(users, 1s), 3);
  EXPECT_TRUE(engagement.user_changed());
  EXPECT_EQ(engagement.update(true, false), EngagementState::Calibrating);
  EXPECT_EQ(engagement.choose(users, 2s), 3);
  EXPECT_FALSE(engagement.user_changed());
  EXPECT_EQ(engagement.update(true, true), EngagementState::Engaged);
  EXPECT_EQ(engagement.choose(users, 3s), 3);
  EXPECT_EQ(engagement.update(false, true), EngagementState::Lost);
}

TEST(Engagement, KeepsWhoSteersWhenSomebodyElseComesNearer) {
  Engagement engagement{{}};
  (void)engagement.choose(std::vector{at(1, 0.2F, 2.5F)}, 0s);
  EXPECT_EQ(engagement.choose(std::vector{at(2, 0, 1.5F), at(1, 0.2F, 2.5F)}, 1s), 1);
}

TEST(Engagement, TakesWhoStandsInFrontOfTheSensor) {
  Engagement engagement{{}};
  EXPECT_EQ(engagement.choose(std::vector{at(1, 1.5F, 2), at(2, 0, 2.2F)}, 0s), 2);
}

TEST(Engagement, WaitsForALostUserBeforeTakingAnother) {
  Engagement engagement{{.lost_timeout = 1000ms}};
  (void)engagement.choose(std::vector{at(1, 0, 2)}, 0s);
  (void)engagement.update(true, true);
  const std::vector<User> other = {at(2, 1, 2)};
  EXPECT_EQ(engagement.choose(other, 500ms), 0);
  EXPECT_EQ(engagement.update(false, true), EngagementState::Lost);
  EXPECT_EQ(engagement.choose(other, 1500ms), 2);
  EXPECT_TRUE(engagement.user_changed());
}

TEST(Engagement, RecognisesHerUnderAnotherIdWhereSheStood) {
  Engagement engagement{{}};
  (void)engagement.choose(std::vector{at(1, 0, 2)}, 0s);
  EXPECT_EQ(engagement.choose(std::vector{at(2, 0.1F, 2)}, 33ms), 2);
  EXPECT_FALSE(engagement.user_changed()) << "her rest pose stays";
}

TEST(Engagement, ForgetsWhoLeft) {
  Engagement engagement{{.lost_timeout = 1000ms}};
  (void)engagement.choose(std::vector{at(1, 0, 2)}, 0s);
  EXPECT_EQ(engagement.choose({}, 3s), 0);
  EXPECT_TRUE(engagement.user_changed());
  EXPECT_EQ(engagement.state(), EngagementState::Absent);
}

}  // namespace
}  // namespace armature
