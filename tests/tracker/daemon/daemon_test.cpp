#include "tracker/daemon/daemon.h"

#include <fstream>
#include <thread>

#include <armature/navproto/control.h>
#include <armature/navproto/feed.h>
#include <armature/navproto/subscriber.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_directory.h"

namespace armature {
namespace {

using namespace std::chrono_literals;

/// Spins until `done` or ten seconds are over: a bound for hanging, not a measure of speed.
template <class Done>
bool eventually(Done done) {
  const auto give_up = std::chrono::steady_clock::now() + 10s;
  while (!done()) {
    if (std::chrono::steady_clock::now() > give_up) return false;
    std::this_thread::sleep_for(5ms);
  }
  return true;
}

class DaemonTest : public testing::Test {
 protected:
  DaemonOptions options_for(const std::string& source, bool lossless = false) {
    DaemonOptions options;
    options.config.source = source;
    options.config.endpoint = endpoint_;
    options.config.lossless = lossless;
    options.config.tracker.rest.mode = RestMode::Auto;
    return options;
  }
  test::TemporaryDirectory directory_;
  std::string endpoint_ = "ipc://" + (directory_.path() / "nav").string();
};

TEST_F(DaemonTest, ARecordedPersonSteersASubscriberAndEndsWithAZero) {
  auto daemon = Daemon::create(options_for("synth:bend_knees?size=320x240&seed=11", true));
  ASSERT_TRUE(daemon) << daemon.error().message;
  navproto::NavSubscriber nav(endpoint_);
  std::stop_source stop;
  Expected<void> result;
  std::thread thread([&] { result = (*daemon)->run(stop.get_token()); });
  bool walked = false, ended = false;
  EXPECT_TRUE(eventually([&] {
    (void)nav.wait(20ms);
    if (const auto message = nav.navigation()) {
      walked |= message->velocity.linear_m_s != 0;
      ended = message->stop_reason == navproto::StopReason::EndOfStream;
    }
    return ended;
  }));
  thread.join();
  EXPECT_TRUE(result);
  EXPECT_TRUE(walked);
  EXPECT_EQ(nav.navigation()->velocity, navproto::Velocity{});
}

TEST_F(DaemonTest, StopsWhenAskedWithAZeroAndAReason) {
  auto daemon = Daemon::create(options_for("synth:stand?size=160x120"));
  ASSERT_TRUE(daemon) << daemon.error().message;
  navproto::NavSubscriber nav(endpoint_);
  std::stop_source stop;
  std::thread thread([&] { EXPECT_TRUE((*daemon)->run(stop.get_token())); });
  EXPECT_TRUE(eventually([&] { return nav.navigation().has_value(); }));
  stop.request_stop();
  EXPECT_TRUE(eventually([&] { return nav.navigation()->stop_reason == navproto::StopReason::Exit; }));
  thread.join();
  EXPECT_EQ(nav.velocity(), navproto::Velocity{});
}

TEST_F(DaemonTest, AnswersStatusSetsWhatItIsAskedToAndRefusesWhatCannotBe) {
  const auto file = directory_.path() / "kiosk.toml";
  std::ofstream(file) << "[navigation]\nwalk = 'step'\n";
  auto options = options_for("synth:stand?size=160x120");
  options.config_file = file;
  auto daemon = Daemon::create(std::move(options));
  ASSERT_TRUE(daemon) << daemon.error().message;
  std::stop_source stop;
  std::thread thread([&] { (void)(*daemon)->run(stop.get_token()); });
  auto client = navproto::ControlClient::connect(endpoint_);
  ASSERT_TRUE(client);
  const auto ask = [&](navproto::ControlRequest request) {
    auto reply = client->request(std::move(request), 5s);
    EXPECT_TRUE(reply) << reply.error().message;
    return reply.value_or(navproto::ControlReply{});
  };

  EXPECT_EQ(ask({}).settings.walk_motion, navproto::MotionId::BendKnees);
  navproto::ControlRequest set{.kind = navproto::RequestKind::Set};
  set.settings.turn_motion = navproto::MotionId::RotateShoulders;
  set.settings.motions = {{.motion = navproto::MotionId::RotateShoulders, .alpha = 0.3F}};
  const auto reply = ask(set);
  EXPECT_EQ(reply.error, "");
  EXPECT_EQ(reply.settings.turn_motion, navproto::MotionId::RotateShoulders);
  EXPECT_FLOAT_EQ(*reply.settings.motions[0].alpha, 0.3F);

  navproto::ControlRequest correlated{.kind = navproto::RequestKind::Set};
  correlated.settings.turn_motion = navproto::MotionId::Step;
  EXPECT_NE(ask(correlated).error.find("allow_correlated"), std::string::npos);

  EXPECT_EQ(ask({.kind = navproto::RequestKind::Save}).error, "");
  const auto saved = load_config(file);
  ASSERT_TRUE(saved);
  EXPECT_EQ(saved->tracker.navigation.pair.turn, MotionId::RotateShoulders);

  std::ofstream(file) << "[navigation]\nwlak = 'step'\n";
  EXPECT_NE(ask({.kind = navproto::RequestKind::Reload}).error.find(":2: navigation.wlak"), std::string::npos);
  std::ofstream(file) << "[navigation]\nwalk = 'step'\n";
  EXPECT_EQ(ask({.kind = navproto::RequestKind::Reload}).settings.walk_motion, navproto::MotionId::Step);
  EXPECT_EQ(ask({.kind = navproto::RequestKind::Rerest}).error, "");
  stop.request_stop();
  thread.join();
}

TEST_F(DaemonTest, FeedsDepthAndMaskToWhoAsksForThem) {
  auto daemon = Daemon::create(options_for("synth:stand?size=160x120"));
  ASSERT_TRUE(daemon) << daemon.error().message;
  std::stop_source stop;
  std::thread thread([&] { (void)(*daemon)->run(stop.get_token()); });
  auto feed = navproto::FeedSubscriber::connect(endpoint_);
  ASSERT_TRUE(feed);
  std::optional<navproto::FeedMessage> frame;
  EXPECT_TRUE(eventually([&] {
    auto received = feed->receive(50ms);
    if (received) frame = std::move(*received);
    return frame.has_value();
  }));
  stop.request_stop();
  thread.join();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->intrinsics.width, 160);
  EXPECT_EQ(frame->depth_mm.size(), 160U * 120);
}

TEST_F(DaemonTest, RefusesAnEndpointInUseAndAMissingSourceInOneLine) {
  auto first = Daemon::create(options_for("synth:stand?size=160x120"));
  ASSERT_TRUE(first) << first.error().message;
  const auto second = Daemon::create(options_for("synth:stand?size=160x120"));
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().message.find(endpoint_), std::string::npos) << second.error().message;
  const auto missing = Daemon::create(options_for("oni:no/such.oni"));
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message.find("no/such.oni"), std::string::npos);
}

}  // namespace
}  // namespace armature
