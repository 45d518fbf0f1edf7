#include "tracker/daemon/daemon.h"

#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <mutex>
#include <thread>

#include <armature/navproto/control.h>
#include <armature/navproto/feed.h>
#include <armature/navproto/subscriber.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/support/temporary_directory.h"
#include "tracker/daemon/log_limit.h"
#include "tracker/daemon/metrics.h"
#include "tracker/synth/open_source.h"

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
/// in a frame's place: garbage, or nothing at all.
class SensorThatStumbles final : public DepthSource {
 public:
  enum class Stumble : std::uint8_t { No, Garbage, Silence };
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
    frame.sensor.time = frame.host.time = clock_->now();
    if (stumble == Stumble::Garbage) std::ranges::fill(frame.depth_mm, std::uint16_t{13'000});
    return status;
  }

 private:
  static constexpr std::string_view kPerson = "synth:bend_knees?size=320x240&seed=11";
  std::shared_ptr<ManualClock> clock_;
  std::function<Stumble()> spoils_;
  std::unique_ptr<DepthSource> person_;
  SourceInfo info_;
};

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

TEST_F(DaemonTest, ARecordedPersonSteersASubscriberAndEndsWithAZero) {
  auto daemon = Daemon::create(options_for("synth:bend_knees?size=320x240&seed=11", true));
  ASSERT_TRUE(daemon) << daemon.error().message;
  navproto::NavSubscriber nav(endpoint_);
  std::stop_source stop;
  Expected<void> result;
  std::atomic<bool> over = false;
  std::thread thread([&] {
    result = (*daemon)->run(stop.get_token());
    over = true;
  });
  bool walked = false, ended = false;
  const auto listen = [&] {
    (void)nav.wait(20ms);
    if (const auto message = nav.navigation()) {
      walked |= message->velocity.linear_m_s != 0;
      ended = message->stop_reason == navproto::StopReason::EndOfStream;
    }
    return ended;
  };
  while (!over) (void)listen();  // under a sanitizer it takes its time
  EXPECT_TRUE(eventually(listen));
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

TEST_F(DaemonTest, PublishesAZeroWhenItsCaptureProcessDiesAndGoesOnWhenItIsBack) {
  // A Kinect's dump, as a sensor: read by a process of its own.
  const auto dump = directory_.path() / "dump";
  std::filesystem::create_directory(dump);
  std::ofstream index(dump / "INDEX.txt");
  for (int i = 0; i < 300; ++i) {
    const std::string name = "d-" + std::to_string(1000 + i / 30.0) + "-1.pgm";
    index << name << "\n";
    std::ofstream image(dump / name, std::ios::binary);
    image << "P5 640 480 65535\n" << std::string(640 * 480 * 2, i % 2 == 0 ? '\x05' : '\x06');
  }
  index.close();
  struct Heard {
    std::chrono::nanoseconds at;
    navproto::StopReason reason;
  };
  std::mutex mutex;
  std::vector<Heard> heard;
  auto options = options_for("process:fakenect:" + dump.string());
  options.published = [&](const navproto::NavigationMessage& message) {
    const std::lock_guard lock(mutex);
    heard.push_back({std::chrono::steady_clock::now().time_since_epoch(), message.stop_reason});
  };
  auto daemon = Daemon::create(std::move(options));
  ASSERT_TRUE(daemon) << daemon.error().message;
  std::stop_source stop;
  std::thread thread([&] { EXPECT_TRUE((*daemon)->run(stop.get_token())); });
  EXPECT_TRUE(eventually([&] { return (*daemon)->metrics().frames.load() > 5; }));

  // The only child of this process is the one that captures.
  pid_t child = -1;
  std::ifstream("/proc/self/task/" + std::to_string(::getpid()) + "/children") >> child;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream(task.path() / "children") >> child;
    if (child > 0) break;
  }
  ASSERT_GT(child, 0);
  const auto killed = std::chrono::steady_clock::now().time_since_epoch();
  ::kill(child, SIGKILL);
  const auto after = [&](navproto::StopReason reason) {
    const std::lock_guard lock(mutex);
    for (const Heard& h : heard) {
      if (h.at >= killed && h.reason == reason) return h.at - killed;
    }
    return std::chrono::nanoseconds(-1);
  };
  EXPECT_TRUE(eventually([&] { return after(navproto::StopReason::SourceFailed) >= 0ns; }));
  RecordProperty("zero_after_us", static_cast<int>(after(navproto::StopReason::SourceFailed) / 1us));
  std::printf("zero %.1f ms after the kill\n",
              static_cast<double>(after(navproto::StopReason::SourceFailed) / 1us) / 1000);
  const auto frames = (*daemon)->metrics().frames.load();
  EXPECT_TRUE(eventually([&] { return (*daemon)->metrics().frames.load() > frames + 3; }));
  EXPECT_EQ((*daemon)->metrics().restarts.load(), 1U);
  stop.request_stop();
  thread.join();
}

TEST_F(DaemonTest, StartsWithoutItsSensorAndSaysSo) {
  auto daemon = Daemon::create(options_for("process:fakenect:" + (directory_.path() / "nothing").string()));
  ASSERT_TRUE(daemon) << daemon.error().message;
  navproto::NavSubscriber nav(endpoint_);
  std::stop_source stop;
  std::thread thread([&] { EXPECT_TRUE((*daemon)->run(stop.get_token())); });
  EXPECT_TRUE(eventually(
      [&] { return nav.navigation() && nav.navigation()->stop_reason == navproto::StopReason::SourceFailed; }));
  EXPECT_TRUE(
      eventually([&] { return nav.health() && nav.health()->source_trouble.find("INDEX.txt") != std::string::npos; }));
  EXPECT_FALSE(nav.health()->source_alive);
  stop.request_stop();
  thread.join();
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

TEST_F(DaemonTest, LetsWhoSteersGoWhenItsConfigurationChanges) {
  const auto file = directory_.path() / "kiosk.toml";
  std::ofstream(file) << "[navigation]\nwalk = 'step'\n";
  auto options = options_for("synth:bend_knees?size=320x240&seed=11", true);
  options.config_file = file;
  Daemon* running = nullptr;
  std::vector<navproto::Engagement> at_reload;
  options.published = [&](const navproto::NavigationMessage& message) {
    if (message.engagement == navproto::Engagement::Engaged && at_reload.empty()) running->request_reload();
    if (message.stop_reason == navproto::StopReason::Reload) at_reload.push_back(message.engagement);
  };
  auto daemon = Daemon::create(std::move(options));
  ASSERT_TRUE(daemon) << daemon.error().message;
  running = daemon->get();
  ASSERT_TRUE(running->run({}));
  EXPECT_EQ(at_reload, std::vector{navproto::Engagement::NoUser});
  EXPECT_EQ(running->metrics().released.load(), 1U);
  EXPECT_EQ(running->metrics().engaged.load(), 2U) << "she stood still again";
}

TEST_F(DaemonTest, ATcpEndpointNeedsKeysOrAnExplicitWord) {
  auto options = options_for("synth:stand?size=160x120");
  options.config.endpoint = "tcp://127.0.0.1:24710";
  options.config.control = endpoint_;
  EXPECT_FALSE(Daemon::create(std::move(options)));
  auto insecure = options_for("synth:stand?size=160x120");
  insecure.config.endpoint = "tcp://127.0.0.1:24710";
  insecure.config.control = endpoint_;
  insecure.config.insecure = true;
  const auto daemon = Daemon::create(std::move(insecure));
  EXPECT_TRUE(daemon) << daemon.error().message;
}

TEST_F(DaemonTest, TellsPrometheusOnLoopback) {
  auto server = MetricsServer::start(0, [] { return prometheus_text(Metrics{}, "1.2.3"); });
  ASSERT_TRUE(server) << server.error().message;
  const auto ask = [&](const std::string& request) {
    const int client = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>((*server)->port()));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(client, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    (void)::send(client, request.data(), request.size(), 0);
    std::string reply(65536, '\0');
    std::size_t size = 0;
    for (ssize_t got = 1; got > 0 && size < reply.size(); size += static_cast<std::size_t>(std::max<ssize_t>(got, 0))) {
      got = ::recv(client, reply.data() + size, reply.size() - size, 0);
    }
    ::close(client);
    return reply.substr(0, size);
  };
  const std::string reply = ask("GET /metrics HTTP/1.1\r\n\r\n");
  EXPECT_TRUE(reply.starts_with("HTTP/1.1 200 OK")) << reply;
  EXPECT_NE(reply.find("armature_info{version=\"1.2.3\"} 1\n"), std::string::npos);
  EXPECT_NE(reply.find("armature_stage_seconds_bucket{stage=\"forest\",le=\"+Inf\"} 0\n"), std::string::npos);
  EXPECT_TRUE(ask("nonsense").starts_with("HTTP/1.1 404"));
  EXPECT_TRUE(ask("GET /metrics HTTP/1.1\r\n\r\n").starts_with("HTTP/1.1 200 OK"));
}

TEST(LogLimit, LetsABurstThroughAndThenOneAPeriod) {
  LogLimit limit;
  std::uint64_t held_back = 0;
  int written = 0;
  for (int i = 0; i < 10'000; ++i) written += limit.admit(3, 100s + i * 10ms, held_back) ? 1 : 0;
  EXPECT_EQ(written, 10 + 9);
  EXPECT_TRUE(limit.admit(4, 100s, held_back)) << "another kind";
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
