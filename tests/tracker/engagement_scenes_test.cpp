#include <map>

#include <gtest/gtest.h>

#include "tracker/installation.h"
#include "tracker/pipeline.h"
#include "tracker/synth/synth_source.h"

namespace armature {
namespace {

using namespace std::chrono_literals;

/// What the tracker said of one frame of a scene.
struct Moment {
  double time_s;
  EngagementState state;
  std::uint8_t user;
  bool moves;
};

struct Played {
  std::vector<Moment> moments;
  std::vector<std::pair<double, TrackerEventKind>> events;

  /// The first time from `after` on at which `state` held; -1 where it never did.
  [[nodiscard]] double first(EngagementState state, double after = 0) const {
    for (const Moment& m : moments) {
      if (m.time_s >= after && m.state == state) return m.time_s;
    }
    return -1;
  }
  [[nodiscard]] bool said(TrackerEventKind kind) const {
    return std::ranges::any_of(events, [&](const auto& event) { return event.second == kind; });
  }
};

/// A room with synthetic people at 160x120, 30 Hz; the first of them is said to be the user.
Played play(std::vector<ActorScript> actors, double duration_s, const SynthOptions& wish = {.furnished = false}) {
  static const auto forest = [] {
    auto loaded = Forest::load(installed_model());
    return loaded ? std::make_shared<const Forest>(std::move(*loaded)) : nullptr;
  }();
  Played played;
  EXPECT_TRUE(forest);
  SynthOptions synth = wish;
  synth.seed = 5;
  synth.width = 160;
  synth.height = 120;
  if (synth.distance_m == 0) synth.distance_m = 2.4;
  Script script;
  script.name = "scene";
  script.duration_s = duration_s;
  script.actors = std::move(actors);
  auto source = SynthSource::open(script, synth);
  if (!forest || !source) return played;
  Pipeline pipeline(forest, {});
  DepthFrame frame;
  while (true) {
    const auto status = (*source)->read(frame, 1s);
    if (!status || *status != ReadStatus::Frame) return played;
    const TrackerOutput& out = pipeline.process(frame.view());
    const double time_s = std::chrono::duration<double>(frame.sensor.time).count();
    const CameraVelocity& v = out.navigation.velocity;
    played.moments.push_back({time_s, out.state, out.user, v.linear_m_s != 0 || v.angular_rad_s != 0});
    for (const TrackerEvent& event : out.events) played.events.emplace_back(time_s, event.kind);
  }
}

using enum EngagementState;

TEST(EngagementScenes, WhoStandsStillForASecondSteers) {
  const Played played = play({ActorScript{}}, 3);
  EXPECT_GE(played.first(Calibrating), 0);
  EXPECT_GE(played.first(Engaged), 0.9);
  EXPECT_LE(played.first(Engaged), 2.0);
  EXPECT_TRUE(played.said(TrackerEventKind::Engaged));
}

TEST(EngagementScenes, WhoMovesWhileHerRestPoseIsTakenWaitsAndStartsAnew) {
  ActorScript restless;
  restless.path = {{0, -0.3, 0, 0}, {0.6, -0.3, 0, 0}, {1.4, 0.3, 0, 0}};
  const Played played = play({restless}, 4);
  const double calibrating = played.first(Calibrating);
  EXPECT_GE(calibrating, 0);
  EXPECT_LE(calibrating, 0.6);
  const double waiting = played.first(Waiting, calibrating);
  EXPECT_GE(waiting, 0.6);
  EXPECT_LE(waiting, 1.4);
  EXPECT_GE(played.first(Calibrating, waiting), waiting);
  EXPECT_GE(played.first(Engaged), 2.3) << "a second after she came to rest";
  EXPECT_LE(played.first(Engaged), 3.6);
}

TEST(EngagementScenes, WhoStandsInTheSecondRowDoesNotSteer) {
  ActorScript sideways, behind_her;
  sideways.path = {{0, 0, 0, 1.5}};  // does not face the sensor, and does not steer either
  behind_her.path = {{0, 0.3, -1, 0}};
  const Played played = play({sideways, behind_her}, 3);
  EXPECT_LT(played.first(Engaged), 0);
}

TEST(EngagementScenes, FurnitureDoesNotSteer) {
  ActorScript nobody;
  nobody.appears_s = 100;
  const Played played = play({nobody}, 3, {.furnished = true});
  EXPECT_FALSE(played.moments.empty());
  EXPECT_LT(played.first(Calibrating), 0);
  EXPECT_LT(played.first(Engaged), 0);
}

TEST(EngagementScenes, SomebodyWhoWalksThroughIsNotedAndDoesNotSteer) {
  ActorScript passer;
  passer.path = {{0, -1.6, 0, 1.5}, {4, 1.6, 0, 1.5}};
  passer.gait = Gait{.from_s = 0, .until_s = 4, .turns_per_s = 1, .stride = 0.8};
  const Played played = play({passer}, 4);
  EXPECT_LT(played.first(Engaged), 0);
}

TEST(EngagementScenes, WhoLeavesStopsAtOnceAndIsReleasedAfterTwoSeconds) {
  ActorScript leaver;
  leaver.leaves_s = 3;
  const Played played = play({leaver}, 6);
  const double lost = played.first(Lost, 3 - 1e-3), gone = played.first(Absent, 3);
  EXPECT_GE(lost, 0);
  EXPECT_LE(lost, 3.25);
  EXPECT_NEAR(gone, 5, 0.25);
  for (const Moment& m : played.moments) {
    EXPECT_FALSE(m.time_s > 3.25 && m.moves) << m.time_s;
  }
  EXPECT_TRUE(played.said(TrackerEventKind::Released));
}

TEST(EngagementScenes, SheIsGoneForASecondAndGoesOnWithoutStandingStillAgain) {
  ActorScript first, again;
  first.leaves_s = 3;
  again.appears_s = 4;  // at the same place
  const Played played = play({first, again}, 6);
  EXPECT_GE(played.first(Lost, 3 - 1e-3), 0);
  const double back = played.first(Engaged, 3.3);
  EXPECT_GE(back, 4);
  EXPECT_LE(back, 4.9);
  EXPECT_EQ(
      std::ranges::count(played.events, TrackerEventKind::RestCaptured, &std::pair<double, TrackerEventKind>::second),
      1);
}

TEST(EngagementScenes, NobodyTakesOver) {
  ActorScript user, rival;
  rival.appears_s = 2.5;
  rival.path = {{0, 0.9, 0.6, 0}};
  const Played played = play({user, rival}, 6);
  ASSERT_GE(played.first(Engaged), 0);
  for (const Moment& m : played.moments) {
    EXPECT_EQ(m.state == Engaged, m.time_s >= played.first(Engaged)) << m.time_s;
  }
  EXPECT_FALSE(played.said(TrackerEventKind::Released));
}

TEST(EngagementScenes, TheNextOneTakesOverOnceTheUserIsReleased) {
  ActorScript user, next;
  user.leaves_s = 3;
  next.appears_s = 2;
  next.path = {{0, 0.9, 0.2, 0}};
  const Played played = play({user, next}, 8);
  EXPECT_GE(played.first(Lost, 3 - 1e-3), 0);
  const double taken = played.first(Engaged, 3.3);
  EXPECT_GE(taken, 5) << "not before the user is released";
  EXPECT_LE(taken, 7);
}

TEST(EngagementScenes, WhoIsTurnedAwayDoesNotTakeOver) {
  ActorScript sideways;
  sideways.path = {{0, 0, 0, 1.5}};
  const Played played = play({sideways}, 3);
  EXPECT_LT(played.first(Engaged), 0);
}

TEST(EngagementScenes, WhoWalksAwayFromHerPlaceStopsSteering) {
  ActorScript walker;
  walker.path = {{0, 0, 0, 0}, {3, 0, 0, 0}, {5, 0, -1.6, 0}};
  const Played played = play({walker}, 6);
  ASSERT_GE(played.first(Engaged), 0);
  EXPECT_GE(played.first(Lost, 3), 3);
  EXPECT_LE(played.first(Lost, 3), 4.7) << "a metre away, at 0.8 m/s";
}

}  // namespace
}  // namespace armature
