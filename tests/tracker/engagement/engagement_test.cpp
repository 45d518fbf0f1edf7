#include "tracker/engagement/engagement.h"

#include <vector>

#include <gtest/gtest.h>

namespace armature {
namespace {

using namespace std::chrono_literals;
using Seen = Engagement::Seen;

User at(std::uint8_t id, float x, float z) {
  return {.id = id, .pixel_count = 5000, .centre = {x, 0, z}};
}

const Eigen::Vector3f kUp(0, -1, 0);
constexpr Seen kStranger{.tracked = true, .facing = true};
constexpr Seen kResting{.tracked = true, .facing = true, .rest_progress = 0.5F};
constexpr Seen kKnown{.tracked = true, .facing = true, .rest_known = true, .rest_progress = 1};

/// Plays frames at 30 Hz; every frame shows the same people and, of whom it chose, the same.
struct Play {
  Engagement engagement{EngagementOptions{}};
  std::chrono::nanoseconds now{0};
  std::uint8_t chosen = 0;
  bool changed = false;
  std::uint8_t turned_away = 0;  // who does not face the sensor

  EngagementState show(const std::vector<User>& users, const Seen& seen, std::chrono::milliseconds span = 33ms) {
    EngagementState state = engagement.state();
    changed = false;
    for (const auto end = now + span; now < end;) {
      now += 33ms;
      chosen = engagement.choose(users, kUp, now);
      changed |= engagement.user_changed();
      Seen now_seen = chosen == 0 ? Seen{.rest_known = seen.rest_known} : seen;
      if (chosen != 0 && chosen == turned_away) now_seen = {.tracked = true};
      state = engagement.update(now_seen);
    }
    return state;
  }
  void engage(const std::vector<User>& users) {
    show(users, kResting, 500ms);
    ASSERT_EQ(show(users, kKnown), EngagementState::Engaged);
  }
};

TEST(Engagement, GoesFromAbsentOverWaitingAndCalibratingToEngaged) {
  Play play;
  EXPECT_EQ(play.show({}, {}), EngagementState::Absent);
  EXPECT_EQ(play.show({at(3, 0, 2)}, kStranger), EngagementState::Waiting);
  EXPECT_TRUE(play.changed);
  EXPECT_EQ(play.chosen, 3);
  EXPECT_EQ(play.show({at(3, 0, 2)}, kResting), EngagementState::Calibrating);
  EXPECT_EQ(play.show({at(3, 0, 2)}, kStranger), EngagementState::Waiting) << "she moved";
  EXPECT_EQ(play.show({at(3, 0, 2)}, kResting), EngagementState::Calibrating);
  EXPECT_EQ(play.show({at(3, 0, 2)}, kKnown), EngagementState::Engaged);
  EXPECT_EQ(play.show({}, kKnown), EngagementState::Lost);
}

TEST(Engagement, NobodyOutsideTheZoneIsACandidate) {
  Play play;
  EXPECT_EQ(play.show({at(1, 0, 5.2F), at(2, 2.4F, 2)}, kStranger, 2s), EngagementState::Absent);
}

TEST(Engagement, DistancesAreMeasuredAlongTheFloor) {
  // A sensor that looks down by 45 degrees sees somebody 4 m along its axis whose feet are 2.8 m away.
  Engagement engagement{{.far_m = 3.5F}};
  const Eigen::Vector3f up = Eigen::Vector3f(0, -1, -1).normalized();
  EXPECT_EQ(engagement.choose(std::vector{at(1, 0, 4)}, up, 33ms), 1);
  EXPECT_EQ(Engagement{{.far_m = 3.5F}}.choose(std::vector{at(1, 0, 4)}, kUp, 33ms), 0);
}

TEST(Engagement, TheClosestOfThoseWhoStandStillIsTheCandidate) {
  Play play;
  for (int frame = 0; frame < 30; ++frame) {
    play.show({at(1, -1, 3), at(2, 1, 1.5F + 0.05F * static_cast<float>(frame)), at(3, 0.3F, 2.5F)}, kStranger);
  }
  EXPECT_EQ(play.chosen, 3) << "1 is farther, 2 walks";
}

TEST(Engagement, WhoTurnsAwayLetsTheNextOneHaveHerTurn) {
  Play play;
  play.turned_away = 1;
  EXPECT_EQ(play.show({at(1, 0, 1.5F)}, kResting, 1s), EngagementState::Waiting);
  play.show({at(1, 0, 1.5F), at(2, 1, 2)}, kResting, 2s);
  EXPECT_EQ(play.chosen, 2);
}

TEST(Engagement, WhoStandsStillFirstIsNotOvertakenByWhoComesCloser) {
  Play play;
  play.show({at(1, 0.5F, 2.5F)}, kResting, 600ms);
  play.show({at(1, 0.5F, 2.5F), at(2, -0.5F, 1.5F)}, kResting, 600ms);
  EXPECT_EQ(play.chosen, 1);
}

TEST(Engagement, WhoNeverComesToRestLosesHerTurnInTheEnd) {
  Play play;
  play.show({at(1, 0.5F, 2)}, kStranger, 500ms);  // a chair
  play.show({at(1, 0.5F, 2), at(2, -0.5F, 2.5F)}, kStranger, 5s);
  EXPECT_EQ(play.chosen, 2);
}

TEST(Engagement, ASecondRowNeverSteers) {
  Play play;
  play.show({at(2, 0.1F, 3)}, kResting, 300ms);
  EXPECT_EQ(play.chosen, 2);
  play.show({at(1, 0.1F, 2), at(2, 0.1F, 3)}, kStranger, 1s);
  EXPECT_EQ(play.chosen, 1) << "she stands in front of 2";
}

TEST(Engagement, NobodyTakesOverFromWhoSteers) {
  Play play;
  play.engage({at(1, 0.2F, 2.5F)});
  EXPECT_EQ(play.show({at(2, -0.5F, 1.5F), at(1, 0.2F, 2.5F)}, kKnown, 3s), EngagementState::Engaged);
  EXPECT_EQ(play.chosen, 1);
}

TEST(Engagement, WhoLeavesHerPlaceStopsInThatFrameAndIsReleasedAfterTwoSeconds) {
  Play play;
  play.engage({at(1, 0, 2)});
  EXPECT_EQ(play.show({at(1, 0, 3.2F)}, kKnown), EngagementState::Lost);
  EXPECT_EQ(play.show({at(1, 0, 3.2F)}, kKnown, 1900ms), EngagementState::Lost);
  EXPECT_FALSE(play.changed);
  play.show({at(1, 0, 3.2F)}, kStranger, 200ms);
  EXPECT_TRUE(play.changed) << "what was known of her is void";
  EXPECT_EQ(play.engagement.state(), EngagementState::Waiting);
}

TEST(Engagement, WhoLeavesTheZoneStopsInThatFrame) {
  Play play;
  play.engage({at(1, 1.8F, 2)});
  EXPECT_EQ(play.show({at(1, 2.3F, 2)}, kKnown), EngagementState::Lost);
}

TEST(Engagement, SheComesBackAtHerPlaceWithinTwoSecondsAndGoesOn) {
  Play play;
  play.engage({at(1, 0, 2)});
  EXPECT_EQ(play.show({}, kKnown, 1s), EngagementState::Lost);
  EXPECT_EQ(play.show({at(7, 0.1F, 2.1F)}, kKnown, 300ms), EngagementState::Engaged) << "under another id";
  EXPECT_FALSE(play.changed) << "her rest pose stays";
  EXPECT_EQ(play.chosen, 7);
}

TEST(Engagement, SomebodyWhoWalksByWhereSheStoodIsNotHer) {
  Play play;
  play.engage({at(1, 0, 2)});
  play.show({}, kKnown, 500ms);
  for (float x = -1; x < 1; x += 0.06F) {
    play.show({at(7, x, 2)}, kKnown);
    EXPECT_NE(play.engagement.state(), EngagementState::Engaged) << x;
  }
}

TEST(Engagement, SomebodyElseWaitsUntilWhoIsLostIsReleased) {
  Play play;
  play.engage({at(1, 0, 2)});
  play.show({at(2, 1, 2)}, kKnown, 1900ms);
  EXPECT_EQ(play.chosen, 0);
  play.show({at(2, 1, 2)}, kStranger, 300ms);
  EXPECT_EQ(play.chosen, 2);
}

TEST(Engagement, WhoIsVisibleButCannotBeTrackedIsReleasedTooAndMayStandStillAgain) {
  Play play;
  play.engage({at(1, 0, 2)});
  EXPECT_EQ(play.show({at(1, 0, 2)}, {.rest_known = true}, 1900ms), EngagementState::Lost);
  play.show({at(1, 0, 2)}, {}, 200ms);
  EXPECT_FALSE(play.engagement.locked());
}

TEST(Engagement, IsTheSameUserUnderAnotherIdWhereSheStandsNow) {
  Play play;
  play.engage({at(1, 0, 2)});
  EXPECT_EQ(play.show({at(2, 0.1F, 2)}, kKnown), EngagementState::Engaged);
  EXPECT_FALSE(play.changed);
}

TEST(Engagement, KeepsHerTurnWhileANewRestPoseIsTaken) {
  Play play;
  play.engage({at(1, 0, 2)});
  EXPECT_EQ(play.show({at(1, 0, 2), at(2, 0.8F, 1.5F)}, kResting, 3s), EngagementState::Calibrating);
  EXPECT_EQ(play.chosen, 1);
  EXPECT_EQ(play.show({at(1, 0, 2), at(2, 0.8F, 1.5F)}, kKnown), EngagementState::Engaged);
}

TEST(Engagement, AClockThatJumpsBackDoesNotKeepALostUser) {
  Play play;
  play.engage({at(1, 0, 2)});
  play.show({}, kKnown, 1s);
  play.now -= 1h;
  play.show({}, {}, 1200ms);
  EXPECT_FALSE(play.engagement.locked());
  play.now += 1h;
  EXPECT_EQ(play.show({}, {}), EngagementState::Absent);
}

TEST(Engagement, FacingIsToldFromTheShoulders) {
  const Engagement engagement{EngagementOptions{}};
  const auto turned = [](float radians) {
    Skeleton skeleton;
    const Eigen::Vector3f half(0.2F * std::cos(radians), 0, 0.2F * std::sin(radians));
    skeleton[JointId::LeftShoulder] = {Eigen::Vector3f(0, -0.3F, 2) + half, 1, JointState::Observed};
    skeleton[JointId::RightShoulder] = {Eigen::Vector3f(0, -0.3F, 2) - half, 1, JointState::Observed};
    skeleton[JointId::Neck] = {{0, -0.35F, 2}, 1, JointState::Observed};
    skeleton[JointId::Waist] = {{0, 0.12F, 2}, 1, JointState::Observed};
    return skeleton;
  };
  EXPECT_TRUE(engagement.faces_sensor(turned(0)));
  EXPECT_TRUE(engagement.faces_sensor(turned(0.9F)));
  EXPECT_FALSE(engagement.faces_sensor(turned(1.3F)));
  EXPECT_FALSE(engagement.faces_sensor(turned(3.1F)));
  EXPECT_FALSE(engagement.faces_sensor(Skeleton{}));
  Skeleton narrow = turned(0.9F);  // read as turned by no more, but too narrow for it
  const Eigen::Vector3f inward =
      0.2F * (narrow[JointId::RightShoulder].position - narrow[JointId::LeftShoulder].position);
  narrow[JointId::LeftShoulder].position += inward;
  narrow[JointId::RightShoulder].position -= inward;
  EXPECT_FALSE(engagement.faces_sensor(narrow));
  for (const JointId joint : {JointId::Neck, JointId::Waist}) {  // what is lost says nothing of how long a torso is
    Skeleton without = turned(0);
    without[joint].state = JointState::Lost;
    EXPECT_FALSE(engagement.faces_sensor(without));
  }
  Skeleton collapsed = turned(0);
  collapsed[JointId::Waist].position = collapsed[JointId::Neck].position;
  EXPECT_FALSE(engagement.faces_sensor(collapsed));
}

}  // namespace
}  // namespace armature
