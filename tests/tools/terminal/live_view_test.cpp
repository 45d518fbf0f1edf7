#include "tools/terminal/live_view.h"

#include <string>

#include <gtest/gtest.h>

namespace armature::tools {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

constexpr nanoseconds kFrame = 33ms;

navproto::NavigationMessage steering(nanoseconds received) {
  navproto::NavigationMessage message;
  message.times.received = received;
  message.user_id = 1;
  message.engagement = navproto::Engagement::Engaged;
  message.walk = 0.5F;
  message.motions[static_cast<std::size_t>(navproto::MotionId::BendKnees)] = {0.3F, 0.6F, 0.5F, 1};
  return message;
}

navproto::SkeletonMessage standing(float x) {
  navproto::SkeletonMessage message;
  message.tracking = true;
  message.user_id = 1;
  message.user_position = {x, 0, 2.5F};
  for (auto& joint : message.joints) joint = {{x, 0.1F, 2.5F}, 1, navproto::JointState::Observed};
  return message;
}

std::string text_of(const LiveState& state, int width, int height) {
  Screen screen(width, height);
  draw_live_view(state, screen);
  return plain_text(screen);
}

TEST(LiveModel, ACameraWalksWithTheVelocity) {
  LiveModel model("ipc:///nav", 0s);
  for (int i = 1; i <= 30; ++i) model.advance({1.0, 0.0}, i * 100ms);
  EXPECT_NEAR(model.state().camera.x_m, 3.0, 1e-9);
  EXPECT_NEAR(model.state().walked_m, 3.0, 1e-9);
  EXPECT_EQ(model.state().path.size(), 31U);
}

TEST(LiveModel, IsFreshForAQuarterOfASecond) {
  LiveModel model("ipc:///nav", 0s);
  model.advance({}, 1s);
  EXPECT_FALSE(model.state().fresh);
  model.take(steering(1s), 1s);
  model.advance({}, 1250ms);
  EXPECT_TRUE(model.state().fresh);
  model.advance({}, 1251ms);
  EXPECT_FALSE(model.state().fresh);
}

TEST(LiveModel, AReplayedStateIsNotFresh) {
  LiveModel model("ipc:///nav", 0s);
  auto message = steering(0s);
  message.header.replayed = true;
  model.take(message, 10s);
  model.advance({}, 10s);
  EXPECT_FALSE(model.state().fresh);
  EXPECT_EQ(model.state().latency.count(), 0);
}

TEST(LiveModel, MeasuresRateAndLatency) {
  LiveModel model("ipc:///nav", 0s);
  for (int i = 1; i <= 60; ++i) {
    model.take(steering(i * kFrame - 3ms), i * kFrame);
    model.advance({}, i * kFrame);
  }
  EXPECT_NEAR(model.state().frames_per_second, 30, 1);
  EXPECT_NEAR(model.state().latency.count(), 0.003, 1e-9);
}

TEST(LiveModel, ThePointOfViewFollowsSlowlyAndJumpsToSomebodyElse) {
  LiveModel model("ipc:///nav", 0s);
  model.take(standing(0));
  model.take(standing(0.2F));
  EXPECT_LT(model.state().anchor.x, 0.05F);
  model.take(standing(2.0F));
  EXPECT_EQ(model.state().anchor.x, 2.0F);
}

TEST(LiveView, SaysWhatItWaitsFor) {
  const LiveModel model("ipc:///nav", 0s);
  EXPECT_NE(text_of(model.state(), 80, 24).find("waiting for ipc:///nav"), std::string::npos);
  EXPECT_EQ(status_text(model.state()), "waiting for ipc:///nav");
}

TEST(LiveView, ShowsMotionsVelocitiesAndPathOf80Columns) {
  LiveModel model("ipc:///nav", 0s);
  for (int i = 1; i <= 60; ++i) {
    model.take(steering(i * kFrame - 3ms), i * kFrame);
    model.take(standing(0));
    model.advance({0.42, 0}, i * kFrame);
  }
  const std::string text = text_of(model.state(), 80, 24);
  for (const char* shown :
       {"● steering", "user 1", "bend knees", "+0.60  +17°", "+0.42 m/s", "path from above", "0:01"}) {
    EXPECT_NE(text.find(shown), std::string::npos) << shown << "\n" << text;
  }
}

TEST(LiveView, SaysWhyItHasStopped) {
  LiveModel model("ipc:///nav", 0s);
  auto message = steering(0s);
  message.stop_reason = navproto::StopReason::EndOfStream;
  model.take(message, 1s);
  model.advance({}, 1s);
  EXPECT_EQ(status_text(model.state()), "stopped: end of stream");
}

TEST(LiveView, FitsScreensOfAnySize) {
  LiveModel model("ipc:///nav", 0s);
  model.take(steering(0s), 1ms);
  model.take(standing(0));
  model.advance({0.4, 0.1}, 2ms);
  for (const int width : {1, 7, 30, 61, 80, 300}) {
    for (const int height : {1, 4, 9, 13, 24, 90}) EXPECT_FALSE(text_of(model.state(), width, height).empty());
  }
}

TEST(LiveLine, HoldsWhatSteersInOneLine) {
  LiveModel model("ipc:///nav", 0s);
  model.take(steering(999ms), 1s);
  model.advance({0.42, -0.5}, 1s);
  EXPECT_EQ(live_line(model.state()),
            "    1.0 s  frame     0  walk +0.42 m/s (bend knees +0.60)  turn  -29 deg/s (lean bust +0.00)  "
            "camera +0.40 -0.10 m  -29 deg  1.0 ms  steering");
}

}  // namespace
}  // namespace armature::tools
