#include <algorithm>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <armature/navproto/control.h>
#include <armature/navproto/subscriber.h>
#include <gtest/gtest.h>

#include "tests/tracker/daemon/daemon_fixture.h"
#include "tracker/daemon/metrics.h"
#include "tracker/synth/open_source.h"

namespace armature {
namespace {

/// A synthetic person as a sensor shows her, on an injected clock: after `seen` frames it is silent for ten seconds.
class SensorWithAGap final : public DepthSource {
 public:
  struct Shown {
    std::vector<StatusLight> lights;
  };
  SensorWithAGap(std::shared_ptr<ManualClock> clock, int seen, std::shared_ptr<Shown> shown)
      : clock_(std::move(clock)), shown_(std::move(shown)), seen_(seen), person_(*open_source(kPerson)) {
    info_ = person_->info();
    info_.live = true;
  }
  [[nodiscard]] const SourceInfo& info() const noexcept override { return info_; }
  [[nodiscard]] SourceHealth health() const override { return {.trouble = trouble_}; }
  void show(StatusLight light) override { shown_->lights.push_back(light); }
  [[nodiscard]] Expected<ReadStatus> read(DepthFrame& frame, std::chrono::milliseconds timeout) override {
    clock_->advance(33ms);
    const int silent = ++reads_ - seen_;
    trouble_ = silent < 0 || silent > 300 ? "" : silent < 20 ? "the capture process died" : "nothing is plugged in";
    if (!trouble_.empty()) return ReadStatus::Timeout;
    auto status = person_->read(frame, timeout);
    frame.sensor.time = frame.host.time = clock_->now();
    return status;
  }

 private:
  static constexpr std::string_view kPerson = "synth:bend_knees?size=320x240&seed=11";
  std::shared_ptr<ManualClock> clock_;
  std::shared_ptr<Shown> shown_;
  int seen_, reads_ = 0;
  std::unique_ptr<DepthSource> person_;
  SourceInfo info_;
  std::string trouble_;
};

TEST_F(DaemonTest, SaysWhyASensorIsSilentShowsItAndLetsWhoSteeredGo) {
  const auto clock = std::make_shared<ManualClock>();
  const auto shown = std::make_shared<SensorWithAGap::Shown>();
  auto options = options_for("a sensor", true);
  options.clock = clock;
  options.source = std::make_unique<SensorWithAGap>(clock, 100, shown);
  std::vector<navproto::Engagement> while_silent;
  options.published = [&](const navproto::NavigationMessage& message) {
    if (message.stop_reason == navproto::StopReason::SourceFailed) while_silent.push_back(message.engagement);
  };
  auto daemon = Daemon::create(std::move(options));
  ASSERT_TRUE(daemon) << daemon.error().message;
  navproto::NavSubscriber nav(endpoint_);
  ASSERT_TRUE((*daemon)->run({}));
  std::vector<std::string> events;
  EXPECT_TRUE(eventually([&] {
    for (const auto& event : nav.take_events()) events.push_back(event.text);
    return !events.empty() && events.back().starts_with("end of");
  }));
  const auto heard = [&](const std::string& text) { return std::count(events.begin(), events.end(), text); };
  EXPECT_EQ(heard("the capture process died"), 1);
  EXPECT_EQ(heard("nothing is plugged in"), 1) << "what is known later is said, too, and once";
  EXPECT_EQ(heard("good frames come again"), 1);
  EXPECT_EQ((*daemon)->metrics().engaged.load(), 2U);
  EXPECT_EQ((*daemon)->metrics().released.load(), 1U) << "ten seconds are longer than two";
  EXPECT_EQ(while_silent, (std::vector{navproto::Engagement::Suspended, navproto::Engagement::NoUser}));
  using enum StatusLight;
  EXPECT_EQ(shown->lights.front(), Ready);
  EXPECT_EQ(std::count(shown->lights.begin(), shown->lights.end(), Trouble), 2) << "and why, as it changed";
  EXPECT_EQ(shown->lights.back(), Off);
}

/// A sensor on an injected clock, which sends good frames until `spoilt` says so, and from then on 300 of garbage: all
/// of 13 metres.
class SensorOfGarbage final : public DepthSource {
 public:
  static constexpr int kGarbage = 300;

  SensorOfGarbage(std::shared_ptr<ManualClock> clock, std::function<bool(int garbage_sent)> spoilt)
      : clock_(std::move(clock)), spoilt_(std::move(spoilt)) {
    info_.intrinsics = {64, 48, 60, 60, 32, 24};
    info_.live = true;
  }
  [[nodiscard]] const SourceInfo& info() const noexcept override { return info_; }
  [[nodiscard]] Expected<ReadStatus> read(DepthFrame& frame, std::chrono::milliseconds) override {
    const bool garbage = spoilt_(garbage_);
    if (garbage && ++garbage_ > kGarbage) return ReadStatus::EndOfStream;
    if (!garbage) std::this_thread::sleep_for(1ms);
    clock_->advance(33ms);
    frame.intrinsics = info_.intrinsics;
    frame.depth_mm.assign(64 * 48, garbage ? 13'000 : 3000);
    frame.depth_mm[0] = static_cast<std::uint16_t>(3000 + frame.sequence % 2);  // no image comes twice
    frame.sensor.time = frame.host.time = clock_->now();
    ++frame.sequence;
    return ReadStatus::Frame;
  }
  void judge(bool good) noexcept override { called_bad_ += good ? 0 : 1; }
  [[nodiscard]] int called_bad() const noexcept { return called_bad_; }

 private:
  std::shared_ptr<ManualClock> clock_;
  std::function<bool(int)> spoilt_;
  int garbage_ = 0, called_bad_ = 0;
  SourceInfo info_;
};

TEST_F(DaemonTest, ASensorThatSendsOnlyGarbageIsLostAndThatIsSaidOnce) {
  const auto clock = std::make_shared<ManualClock>();
  navproto::NavSubscriber nav(endpoint_);
  auto heard_last = navproto::StopReason::None;
  auto options = options_for("a sensor", true);
  options.clock = clock;
  options.published = [&](const navproto::NavigationMessage& message) { heard_last = message.stop_reason; };
  auto source = std::make_unique<SensorOfGarbage>(clock, [&](int sent) {
    EXPECT_TRUE(sent != 1 || heard_last == navproto::StopReason::SourceFailed) << "at once";
    return sent > 0 || nav.health();
  });
  const SensorOfGarbage& sensor = *source;
  options.source = std::move(source);
  auto daemon = Daemon::create(std::move(options));
  ASSERT_TRUE(daemon) << daemon.error().message;
  ASSERT_TRUE((*daemon)->run({}));
  std::vector<navproto::EventMessage> events;
  EXPECT_TRUE(eventually([&] {
    for (auto& event : nav.take_events()) events.push_back(std::move(event));
    return !events.empty() && events.back().kind == navproto::EventKind::Stopping;
  }));
  const auto heard = [&](navproto::EventKind kind) {
    return std::ranges::count(events, kind, &navproto::EventMessage::kind);
  };
  EXPECT_EQ(heard(navproto::EventKind::Warning), 1) << "at the first of them";
  EXPECT_EQ(heard(navproto::EventKind::SourceLost), 1);
  EXPECT_EQ(heard(navproto::EventKind::SourceRecovered), 0);
  EXPECT_FALSE((*daemon)->metrics().source_alive.load());
  EXPECT_EQ((*daemon)->metrics().bad_frames.load(), SensorOfGarbage::kGarbage);
  EXPECT_EQ(sensor.called_bad(), SensorOfGarbage::kGarbage) << "so that it can be brought back";
  EXPECT_FALSE(nav.health()->source_alive);
  EXPECT_GT(nav.health()->frames_received, nav.health()->frames_processed + 200) << "refused ones count";
  EXPECT_EQ(nav.health()->source_trouble, "a sensor sends no good frames: a garbage frame");
}

TEST_F(DaemonTest, ASensorThatSendsOnlyGarbageFromTheFirstFrameOnIsLost) {
  const auto clock = std::make_shared<ManualClock>();
  auto options = options_for("a sensor", true);
  options.clock = clock;
  options.source = std::make_unique<SensorOfGarbage>(clock, [](int) { return true; });
  auto daemon = Daemon::create(std::move(options));
  ASSERT_TRUE(daemon) << daemon.error().message;
  ASSERT_TRUE((*daemon)->run({}));
  EXPECT_FALSE((*daemon)->metrics().source_alive.load());
  EXPECT_EQ((*daemon)->metrics().frames.load(), 0U);
  EXPECT_EQ((*daemon)->metrics().stops.load(), 1U);
}

/// A synthetic person who walks by a bent knee, as a sensor shows her on an injected clock, but for what `spoils` puts
/// in a frame's place: garbage, a frame that shows nothing, the image before, or nothing at all.
class SensorThatStumbles final : public DepthSource {
 public:
  enum class Stumble : std::uint8_t { No, Garbage, Darkness, Freeze, Silence };
  SensorThatStumbles(std::shared_ptr<ManualClock> clock, std::function<Stumble()> spoils)
      : clock_(std::move(clock)), spoils_(std::move(spoils)), person_(*open_source(kPerson)), info_(person_->info()) {
    info_.live = true;
  }
  [[nodiscard]] const SourceInfo& info() const noexcept override { return info_; }
  [[nodiscard]] Expected<ReadStatus> read(DepthFrame& frame, std::chrono::milliseconds timeout) override {
    clock_->advance(33ms);
    const Stumble stumble = spoils_();
    if (stumble == Stumble::Silence) return ReadStatus::Timeout;
    auto status = person_->read(frame, timeout);
    if (stumble == Stumble::Freeze) frame.depth_mm = shown_;
    shown_ = frame.depth_mm;
    frame.sensor.time = frame.host.time = clock_->now();
    if (stumble == Stumble::Garbage) std::ranges::fill(frame.depth_mm, std::uint16_t{13'000});
    if (stumble == Stumble::Darkness) std::ranges::fill(frame.depth_mm, std::uint16_t{0});
    return status;
  }

 private:
  static constexpr std::string_view kPerson = "synth:bend_knees?size=320x240&seed=11";
  std::shared_ptr<ManualClock> clock_;
  std::function<Stumble()> spoils_;
  std::unique_ptr<DepthSource> person_;
  std::vector<std::uint16_t> shown_;
  SourceInfo info_;
};

TEST_F(DaemonTest, ASensorThatSeesNothingIsSaidToUntilItSeesAgain) {
  using Stumble = SensorThatStumbles::Stumble;
  constexpr int kFirstDark = 30, kLastDark = 230;  // more than six seconds
  const auto clock = std::make_shared<ManualClock>();
  auto options = options_for("a sensor", true);
  options.clock = clock;
  std::stop_source stop;
  navproto::NavSubscriber nav(endpoint_);
  int shown = 0;
  std::string trouble;
  options.source = std::make_unique<SensorThatStumbles>(clock, [&] {
    if (shown == 0 && !nav.health()) {
      std::this_thread::sleep_for(5ms);
      return Stumble::No;
    }
    ++shown;
    if (shown == kLastDark) {
      EXPECT_TRUE(eventually([&] { return !(trouble = nav.health()->source_trouble).empty(); }));
      EXPECT_TRUE(nav.health()->source_alive);
    }
    if (shown == kLastDark + 60) stop.request_stop();
    return shown < kFirstDark || shown > kLastDark ? Stumble::No : Stumble::Darkness;
  });
  auto daemon = Daemon::create(std::move(options));
  ASSERT_TRUE(daemon) << daemon.error().message;
  ASSERT_TRUE((*daemon)->run(stop.get_token()));
  const std::string blind = "sees nothing: is the lens covered, the projector off, the sun on it, or all too near?";
  EXPECT_EQ(trouble, blind);
  EXPECT_TRUE(eventually([&] { return nav.health()->source_trouble.empty(); }));
  EXPECT_FALSE((*daemon)->metrics().source_blind.load());
  std::vector<std::string> warnings;
  for (const auto& event : nav.take_events())
    if (event.kind == navproto::EventKind::Warning) warnings.push_back(event.text);
  EXPECT_EQ(warnings, (std::vector<std::string>{"a sensor: a torn frame; the camera is stopped", "a sensor " + blind,
                                                "a sensor sees again"}));
}

TEST_F(DaemonTest, WhoIsLostAndComesBackBlindDoesNotSeeAgain) {
  using Stumble = SensorThatStumbles::Stumble;
  const auto clock = std::make_shared<ManualClock>();
  auto options = options_for("a sensor", true);
  options.clock = clock;
  std::stop_source stop;
  navproto::NavSubscriber nav(endpoint_);
  int shown = 0;
  options.source = std::make_unique<SensorThatStumbles>(clock, [&] {
    if (shown == 0 && !nav.health()) {
      std::this_thread::sleep_for(5ms);
      return Stumble::No;
    }
    if (++shown == 260) stop.request_stop();
    return shown < 200 || shown > 230 ? Stumble::Darkness : Stumble::Silence;
  });
  auto daemon = Daemon::create(std::move(options));
  ASSERT_TRUE(daemon) << daemon.error().message;
  ASSERT_TRUE((*daemon)->run(stop.get_token()));
  EXPECT_TRUE((*daemon)->metrics().source_blind.load());
  std::vector<std::string> events;
  EXPECT_TRUE(eventually([&] {
    for (const auto& event : nav.take_events()) events.push_back(event.text);
    return !events.empty() && events.back() == "asked to stop";
  }));
  EXPECT_EQ(std::ranges::count(events, "good frames come again"), 1);
  EXPECT_EQ(std::ranges::count(events, "a sensor sees again"), 0);
}

TEST_F(DaemonTest, NobodySteersByAnImageThatIsFrozen) {
  using Stumble = SensorThatStumbles::Stumble;
  const auto clock = std::make_shared<ManualClock>();
  auto options = options_for("a sensor", true);
  options.clock = clock;
  std::stop_source stop;
  bool moves = false;
  std::chrono::nanoseconds frozen_since{0};
  options.published = [&](const navproto::NavigationMessage& message) {
    moves = message.walk != 0;
    EXPECT_TRUE(!moves || frozen_since == 0ns || clock->now() - frozen_since <= 250ms);
  };
  int frozen = 0;
  options.source = std::make_unique<SensorThatStumbles>(clock, [&] {
    if (frozen == 0 && !moves) return Stumble::No;
    if (frozen++ == 0) frozen_since = clock->now();
    if (frozen > 200) stop.request_stop();
    return Stumble::Freeze;
  });
  auto daemon = Daemon::create(std::move(options));
  ASSERT_TRUE(daemon) << daemon.error().message;
  ASSERT_TRUE((*daemon)->run(stop.get_token()));
  EXPECT_FALSE((*daemon)->metrics().source_alive.load());
  EXPECT_EQ((*daemon)->metrics().released.load(), 1U);
  EXPECT_GT(frozen, 200) << "she walked";
}

TEST_F(DaemonTest, ABadFrameExplainsNoSilenceThatFollowsIt) {
  using Stumble = SensorThatStumbles::Stumble;
  const auto clock = std::make_shared<ManualClock>();
  auto options = options_for("a sensor", true);
  options.clock = clock;
  std::stop_source stop;
  navproto::NavSubscriber nav(endpoint_);
  int spoilt = 0;
  options.source = std::make_unique<SensorThatStumbles>(clock, [&] {
    if (spoilt == 0 && !nav.health()) {
      std::this_thread::sleep_for(5ms);
      return Stumble::No;
    }
    if (++spoilt > 10) stop.request_stop();
    return spoilt == 1 ? Stumble::Garbage : Stumble::Silence;
  });
  auto daemon = Daemon::create(std::move(options));
  ASSERT_TRUE(daemon) << daemon.error().message;
  ASSERT_TRUE((*daemon)->run(stop.get_token()));
  std::vector<std::string> warnings;
  EXPECT_TRUE(eventually([&] {
    for (const auto& event : nav.take_events()) {
      if (event.kind == navproto::EventKind::Stopping) return true;
      const bool warns = event.kind == navproto::EventKind::Warning || event.kind == navproto::EventKind::SourceLost;
      if (warns) warnings.push_back(event.text);
    }
    return false;
  }));
  EXPECT_EQ(warnings, (std::vector<std::string>{"a sensor: a garbage frame; the camera is stopped",
                                                "a sensor has sent no frame for 132 ms"}));
}

TEST_F(DaemonTest, ASensorThatFallsSilentAfterGarbageIsSaidToBeSilent) {
  using Stumble = SensorThatStumbles::Stumble;
  const auto clock = std::make_shared<ManualClock>();
  auto options = options_for("a sensor", true);
  options.clock = clock;
  std::stop_source stop;
  int spoilt = 0;
  options.source = std::make_unique<SensorThatStumbles>(clock, [&] {
    if (++spoilt > 60) stop.request_stop();
    return spoilt < 10 ? Stumble::No : spoilt < 30 ? Stumble::Garbage : Stumble::Silence;
  });
  auto daemon = Daemon::create(std::move(options));
  ASSERT_TRUE(daemon) << daemon.error().message;
  navproto::NavSubscriber nav(endpoint_);
  ASSERT_TRUE((*daemon)->run(stop.get_token()));
  std::vector<std::string> events;
  EXPECT_TRUE(eventually([&] {
    for (const auto& event : nav.take_events()) {
      if (event.kind == navproto::EventKind::Stopping) return true;
      events.push_back(event.text);
    }
    return false;
  }));
  const auto heard = [&](const std::string& text) { return std::ranges::count(events, text); };
  EXPECT_EQ(heard("a sensor sends no good frames: a garbage frame"), 1);
  EXPECT_EQ(heard("a sensor has sent no frame for 231 ms"), 1);
}

/// A sensor that was said to send thirty frames a second, and sends six.
class SlowSensor final : public DepthSource {
 public:
  explicit SlowSensor(std::shared_ptr<ManualClock> clock) : clock_(std::move(clock)) {
    info_.intrinsics = {64, 48, 60, 60, 32, 24};
    info_.live = true;
  }
  [[nodiscard]] const SourceInfo& info() const noexcept override { return info_; }
  [[nodiscard]] SourceHealth health() const override { return {.frames_per_second = 6}; }
  [[nodiscard]] Expected<ReadStatus> read(DepthFrame& frame, std::chrono::milliseconds) override {
    clock_->advance(33ms);
    if (++reads_ > 300) return ReadStatus::EndOfStream;
    if (reads_ % 5 != 0) return ReadStatus::Timeout;
    frame.intrinsics = info_.intrinsics;
    frame.depth_mm.assign(64 * 48, 3000);
    frame.depth_mm[0] = static_cast<std::uint16_t>(3000 + reads_ % 2);  // no image comes twice
    frame.sensor.time = frame.host.time = clock_->now();
    return ReadStatus::Frame;
  }

 private:
  std::shared_ptr<ManualClock> clock_;
  int reads_ = 0;
  SourceInfo info_;
};

TEST_F(DaemonTest, ASlowSensorIsNotLostBetweenItsFrames) {
  auto options = options_for("a sensor", true);
  const auto clock = std::make_shared<ManualClock>();
  options.clock = clock;
  options.source = std::make_unique<SlowSensor>(clock);
  auto daemon = Daemon::create(std::move(options));
  ASSERT_TRUE(daemon) << daemon.error().message;
  ASSERT_TRUE((*daemon)->run({}));
  EXPECT_EQ((*daemon)->metrics().frames.load(), 60U);
  EXPECT_EQ((*daemon)->metrics().stops.load(), 0U);
}

TEST_F(DaemonTest, SpeedsUpFromAStandstillAfterEveryZeroThatItPublished) {
  using Stumble = SensorThatStumbles::Stumble;
  for (const auto& [stumble, frames] : {std::pair{Stumble::Garbage, 1}, {Stumble::Silence, 8}}) {
    const auto clock = std::make_shared<ManualClock>();
    auto options = options_for("a sensor", true);
    const ActuatorOptions actuator = options.config.tracker.navigation.actuator;
    int spoilt = 0;
    float before_m_s = 0;
    std::vector<float> after_m_s;  // the zero's and those of the messages that follow it
    std::stop_source stop;
    options.clock = clock;
    options.source = std::make_unique<SensorThatStumbles>(
        clock, [&] { return before_m_s > 0.8F && spoilt < frames ? (++spoilt, stumble) : Stumble::No; });
    options.published = [&](const navproto::NavigationMessage& message) {
      const float speed_m_s = message.velocity.linear_m_s;
      if (spoilt == 0) before_m_s = std::abs(speed_m_s);
      if (spoilt > 0) after_m_s.push_back(std::abs(speed_m_s));
      if (after_m_s.size() > 4) stop.request_stop();
    };
    auto daemon = Daemon::create(std::move(options));
    ASSERT_TRUE(daemon) << daemon.error().message;
    ASSERT_TRUE((*daemon)->run(stop.get_token()));
    ASSERT_EQ(spoilt, frames) << "she never walked";
    ASSERT_GT(after_m_s.size(), 4U);
    EXPECT_EQ(after_m_s[0], 0.0F);
    for (int n = 1; n <= 3; ++n) {
      const float most = static_cast<float>(n) * 0.033F * actuator.walk_acceleration_m_s2;
      EXPECT_LE(after_m_s[static_cast<std::size_t>(n)], most + 1e-4F);
    }
    EXPECT_GT(after_m_s[3], 0.1F) << "she still steers";
  }
}
TEST_F(DaemonTest, WhileASensorIsSilentThatStaysTheReasonWhateverIsAskedFor) {
  const auto file = directory_.path() / "kiosk.toml";
  std::ofstream(file) << "[navigation]\nwalk = 'step'\n";
  auto options = options_for("process:fakenect:" + (directory_.path() / "nothing").string());
  options.config_file = file;
  std::vector<navproto::StopReason> reasons;  // written by the daemon's thread, read when that is over
  options.published = [&](const navproto::NavigationMessage& message) { reasons.push_back(message.stop_reason); };
  auto daemon = Daemon::create(std::move(options));
  ASSERT_TRUE(daemon) << daemon.error().message;
  navproto::NavSubscriber nav(endpoint_);
  auto client = navproto::ControlClient::connect(endpoint_);
  ASSERT_TRUE(client);
  std::stop_source stop;
  std::thread thread([&] { EXPECT_TRUE((*daemon)->run(stop.get_token())); });
  EXPECT_TRUE(eventually(
      [&] { return nav.navigation() && nav.navigation()->stop_reason == navproto::StopReason::SourceFailed; }));
  for (const auto kind : {navproto::RequestKind::Rerest, navproto::RequestKind::Reload}) {
    const auto reply = client->request({.kind = kind}, 5s);
    EXPECT_TRUE(reply && reply->error.empty());
  }
  stop.request_stop();
  thread.join();
  using enum navproto::StopReason;
  EXPECT_EQ(reasons, (std::vector{NoUser, SourceFailed, SourceFailed, SourceFailed, Exit}));
}

}  // namespace
}  // namespace armature
