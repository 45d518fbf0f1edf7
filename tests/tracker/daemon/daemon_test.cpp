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

#include "tests/tracker/daemon/daemon_fixture.h"
#include "tracker/daemon/log_limit.h"
#include "tracker/daemon/metrics.h"
#include "tracker/synth/open_source.h"

namespace armature {
namespace {

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

TEST_F(DaemonTest, ReloadsNothingThatItCouldNotStartWithAndNamesFileLineAndKey) {
  const auto file = directory_.path() / "kiosk.toml";
  const std::string source = "[source]\nuri = 'synth:stand?size=160x120'\n";
  const std::string publish = "[publish]\nendpoint = '" + endpoint_ + "'\n";
  std::ofstream(file) << source << publish;
  auto config = load_config(file);
  ASSERT_TRUE(config) << config.error().message;
  auto daemon = Daemon::create({.config = std::move(*config), .config_file = file});
  ASSERT_TRUE(daemon) << daemon.error().message;
  std::stop_source stop;
  std::thread thread([&] { (void)(*daemon)->run(stop.get_token()); });
  auto client = navproto::ControlClient::connect(endpoint_);
  ASSERT_TRUE(client);
  const auto reload = [&](const std::string& text) {
    std::ofstream(file) << text;
    const auto reply = client->request({.kind = navproto::RequestKind::Reload}, 5s);
    return reply ? reply->error : reply.error().message;
  };
  const struct {
    std::string text, place;
  } wrongs[] = {
      {"[source]\nuri = 'kinect:0'\n" + publish, ":2: source.uri = kinect:0: expected oni:FILE"},
      {"[source]\nuri = 'oni:no/such.oni'\n" + publish, ":2: source.uri = oni:no/such.oni: "},
      {source + "[publish]\nendpoint = 'bogus'\n", ":4: publish.endpoint = bogus: expected ipc://PATH or tcp"},
      {source + "[publish]\nendpoint = 'tcp://127.0.0.1:24712'\n",
       ":4: publish.endpoint = tcp://127.0.0.1:24712: every"},
      {source + "[publish]\nendpoint = 'tcp://127.0.0.1:24712'\nkeys = 'no/such.key'\nallow = 'no/such'\n",
       ":5: publish.keys = no/such.key: no such file"},
      {source + "[publish]\nendpoint = 'ipc://no/such/nav'\n",
       ":4: publish.endpoint = ipc://no/such/nav: its directory does not exist"},
      {source + publish + "[control]\nendpoint = 'ipc://no/such/nav'\n",
       ":6: control.endpoint = ipc://no/such/nav: its directory does not exist"},
      {source + publish + "[control]\nendpoint = 'ipc:'\n", ":6: control.endpoint = ipc:: expected ipc://PATH"},
      {source + publish + "[control]\nuids = 'me'\n", ":6: control.uids = me: expected numbers"},
      {source + publish + "[skeleton]\nmodel = 'no/such.forest'\n", ":6: skeleton.model = no/such.forest: "},
      {publish, "no source"},
  };
  for (const auto& wrong : wrongs) {
    const std::string why = reload(wrong.text);
    const std::string expected = (wrong.place.starts_with(':') ? file.string() : "") + wrong.place;
    EXPECT_EQ(why.substr(0, expected.size()), expected);
    auto again = load_config(file);
    ASSERT_TRUE(again) << again.error().message;
    const auto started = Daemon::create({.config = std::move(*again), .config_file = file});
    ASSERT_FALSE(started) << wrong.place;
    EXPECT_EQ(started.error().message, why) << "as at the start";
  }
  EXPECT_EQ((*daemon)->metrics().reloads_refused.load(), std::size(wrongs));
  EXPECT_EQ(reload(source + publish + "[navigation]\nwalk = 'step'\n"), "");
  EXPECT_EQ((*daemon)->metrics().reloads.load(), 1U);
  stop.request_stop();
  thread.join();
}

TEST_F(DaemonTest, SavesWhatWaitsForARestartAsTheFileHasItUnlessItCouldNotStartSo) {
  const auto file = directory_.path() / "kiosk.toml";
  const std::string publish = "[publish]\nendpoint = '" + endpoint_ + "'\n";
  std::ofstream(file) << publish << "[source]\nuri = 'synth:stand?size=160x120'\n";
  auto config = load_config(file);
  ASSERT_TRUE(config) << config.error().message;
  auto daemon = Daemon::create({.config = std::move(*config), .config_file = file});
  ASSERT_TRUE(daemon) << daemon.error().message;
  std::stop_source stop;
  std::thread thread([&] { (void)(*daemon)->run(stop.get_token()); });
  auto client = navproto::ControlClient::connect(endpoint_);
  ASSERT_TRUE(client);
  const auto saved = [&](const std::string& text) {
    std::ofstream(file) << text;
    const auto reply = client->request({.kind = navproto::RequestKind::Save}, 5s);
    EXPECT_TRUE(reply && reply->error.empty());
    return load_config(file).value_or(Config{});
  };
  const Config changed = saved(publish + "[source]\nuri = 'synth:bend_knees'\n[health]\nmetrics_port = 24760\n");
  EXPECT_EQ(changed.source, "synth:bend_knees");
  EXPECT_EQ(changed.metrics_port, 24760);
  const Config mended = saved("[publish]\nendpoint = 'bogus'\n[source]\nuri = 'synth:bend_knees'\n");
  EXPECT_EQ(mended.endpoint, endpoint_);
  EXPECT_EQ(mended.source, "synth:stand?size=160x120");
  stop.request_stop();
  thread.join();
}

TEST_F(DaemonTest, SaysThatItHasNoFileToReload) {
  auto daemon = Daemon::create(options_for("synth:stand?size=160x120"));
  ASSERT_TRUE(daemon) << daemon.error().message;
  navproto::NavSubscriber nav(endpoint_);
  std::stop_source stop;
  std::thread thread([&] { (void)(*daemon)->run(stop.get_token()); });
  (*daemon)->request_reload();
  std::string said;
  EXPECT_TRUE(eventually([&] {
    (void)nav.wait(20ms);
    for (const auto& event : nav.take_events()) {
      if (event.kind == navproto::EventKind::ConfigRejected) said = event.text;
    }
    return !said.empty();
  }));
  EXPECT_NE(said.find("started without --config"), std::string::npos) << said;
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
