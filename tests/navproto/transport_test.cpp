#include <csignal>
#include <fstream>
#include <thread>

#include <armature/navproto/codec.h>
#include <armature/navproto/endpoints.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zmq.h>

#include "tests/navproto/transport_fixture.h"

namespace armature::navproto {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

TEST(Transport, ALateJoinerGetsTheLastStateAtOnce) {
  const TemporaryEndpoint endpoint;
  auto publisher = Publisher::bind(endpoint.uri());
  ASSERT_TRUE(publisher) << publisher.error().message;
  NavigationMessage navigation = walking(0.5);
  ASSERT_TRUE(publisher->publish_navigation(navigation));
  SkeletonMessage skeleton;
  skeleton.user_id = 7;
  ASSERT_TRUE(publisher->publish_skeleton(skeleton));
  for (int i = 0; i < 20; ++i) {
    EventMessage event;
    event.text = "event " + std::to_string(i);
    ASSERT_TRUE(publisher->publish_event(event));
  }
  HealthMessage health;
  health.source = "synth:test";
  ASSERT_TRUE(publisher->publish_health(health));

  NavSubscriber nav(endpoint.uri());
  std::vector<EventMessage> events;
  ASSERT_TRUE(repeat_until([&] { publisher->serve(); },
                           [&] {
                             for (EventMessage& each : nav.take_events()) events.push_back(std::move(each));
                             return nav.navigation() && nav.skeleton() && nav.health() && events.size() >= 16;
                           }));
  EXPECT_EQ(nav.navigation()->velocity.linear_m_s, 0.5);
  EXPECT_TRUE(nav.navigation()->header.replayed);
  EXPECT_EQ(nav.navigation()->header.session_id, publisher->session_id());
  EXPECT_EQ(nav.skeleton()->user_id, 7U);
  EXPECT_EQ(nav.health()->source, "synth:test");
  ASSERT_EQ(events.size(), 16U);
  EXPECT_EQ(events.front().text, "event 4");
  EXPECT_EQ(events.back().text, "event 19");
  EXPECT_FALSE(nav.error());
}

TEST(Transport, AReplayReachesNobodyTwice) {
  const TemporaryEndpoint endpoint;
  auto publisher = Publisher::bind(endpoint.uri());
  ASSERT_TRUE(publisher);
  EventMessage event;
  event.text = "once";
  ASSERT_TRUE(publisher->publish_event(event));
  NavSubscriber first(endpoint.uri());
  int first_got = 0;
  int second_got = 0;
  const auto serve = [&] { publisher->serve(); };
  ASSERT_TRUE(repeat_until(serve, [&] { return (first_got += static_cast<int>(first.take_events().size())) > 0; }));
  NavSubscriber second(endpoint.uri());
  ASSERT_TRUE(repeat_until(serve, [&] { return (second_got += static_cast<int>(second.take_events().size())) > 0; }));
  // What was replayed to the second has passed the first by, too, once both have a later event.
  event.text = "later";
  ASSERT_TRUE(publisher->publish_event(event));
  ASSERT_TRUE(repeat_until(serve, [&] { return (first_got += static_cast<int>(first.take_events().size())) >= 2; }));
  EXPECT_EQ(first_got, 2);
}

TEST(Transport, VelocityIsZeroBeforeTheFirstMessageAndAQuarterOfASecondAfterTheLast) {
  const TemporaryEndpoint endpoint;
  SharedClock clock;
  NavSubscriber nav(endpoint.uri(), {.now = clock.now()});
  EXPECT_EQ(nav.velocity(), Velocity{});
  auto publisher = Publisher::bind(endpoint.uri(), {.now = clock.now()});
  ASSERT_TRUE(publisher);
  NavigationMessage message = walking(0.5);
  ASSERT_TRUE(repeat_until([&] { publisher->publish_navigation(message); }, [&] { return nav.navigation(); }));
  EXPECT_EQ(nav.velocity(), (Velocity{0.5, 0}));
  clock.advance(milliseconds(250));
  EXPECT_EQ(nav.velocity(), (Velocity{0.5, 0}));
  clock.advance(nanoseconds(1));
  EXPECT_EQ(nav.velocity(), Velocity{});
  EXPECT_EQ(nav.navigation()->velocity.linear_m_s, 0.5) << "the message itself stays";
}

TEST(Transport, AReplayedStateDoesNotMoveACamera) {
  const TemporaryEndpoint endpoint;
  SharedClock clock;
  auto publisher = Publisher::bind(endpoint.uri(), {.now = clock.now()});
  ASSERT_TRUE(publisher);
  NavigationMessage message = walking(0.5);
  ASSERT_TRUE(publisher->publish_navigation(message));
  clock.advance(milliseconds(300));
  NavSubscriber nav(endpoint.uri(), {.now = clock.now()});
  ASSERT_TRUE(repeat_until([&] { publisher->serve(); }, [&] { return nav.navigation(); }));
  EXPECT_EQ(nav.navigation()->velocity.linear_m_s, 0.5);
  EXPECT_EQ(nav.velocity(), Velocity{});
}

TEST(Transport, APublisherThatComesBackIsHeardAgain) {
  const TemporaryEndpoint endpoint;
  NavSubscriber nav(endpoint.uri());
  std::uint64_t last_session = 0;
  for (int life = 1; life <= 3; ++life) {
    auto publisher = Publisher::bind(endpoint.uri());
    ASSERT_TRUE(publisher) << publisher.error().message;
    NavigationMessage message = walking(life);
    ASSERT_TRUE(repeat_until([&] { publisher->publish_navigation(message); },
                             [&] { return nav.navigation() && nav.navigation()->velocity.linear_m_s == life; }));
    EXPECT_NE(nav.navigation()->header.session_id, last_session);
    last_session = nav.navigation()->header.session_id;
  }
}

TEST(Transport, WhatWasQueuedAtTheEndStillArrives) {
  const TemporaryEndpoint endpoint;
  NavSubscriber nav(endpoint.uri());
  {
    auto publisher = Publisher::bind(endpoint.uri());
    ASSERT_TRUE(publisher);
    NavigationMessage message = walking(1);
    ASSERT_TRUE(repeat_until([&] { publisher->publish_navigation(message); }, [&] { return nav.navigation(); }));
    message.velocity = {};
    message.stop_reason = StopReason::Exit;
    ASSERT_TRUE(publisher->publish_navigation(message));
  }
  EXPECT_TRUE(repeat_until([] {}, [&] { return nav.navigation()->stop_reason == StopReason::Exit; }));
  EXPECT_EQ(nav.velocity(), Velocity{});
}

TEST(Transport, EventsAreNeverConflated) {
  const TemporaryEndpoint endpoint;
  auto publisher = Publisher::bind(endpoint.uri());
  ASSERT_TRUE(publisher);
  NavSubscriber nav(endpoint.uri());
  EventMessage event;
  ASSERT_TRUE(publisher->publish_event(event));
  ASSERT_TRUE(repeat_until([&] { publisher->serve(); }, [&] { return !nav.take_events().empty(); }));
  for (int i = 0; i < 1000; ++i) {
    event.text = std::to_string(i);
    ASSERT_TRUE(publisher->publish_event(event));
  }
  std::vector<std::string> texts;
  ASSERT_TRUE(repeat_until([] {},
                           [&] {
                             for (const EventMessage& each : nav.take_events()) texts.push_back(each.text);
                             return texts.size() >= 1000;
                           }));
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(texts[static_cast<std::size_t>(i)], std::to_string(i));
}

TEST(Transport, WhatMayNotTravelIsRefusedAndCounted) {
  const TemporaryEndpoint endpoint;
  auto publisher = Publisher::bind(endpoint.uri());
  ASSERT_TRUE(publisher);
  NavigationMessage message = walking(1);
  message.stop_reason = StopReason::NoUser;
  EXPECT_FALSE(publisher->publish_navigation(message));
  EXPECT_EQ(publisher->counters().refused, 1U);
  EXPECT_EQ(publisher->counters().sent, 0U);
}

TEST(Transport, TextThatIsNoTextIsMadeSo) {
  const TemporaryEndpoint endpoint;
  auto publisher = Publisher::bind(endpoint.uri());
  ASSERT_TRUE(publisher);
  EventMessage event;
  event.text = "two\nlines \xff " + std::string(2000, 'x');
  EXPECT_TRUE(publisher->publish_event(event));
  EXPECT_TRUE(event.text.starts_with("two?lines ? xxx"));
  EXPECT_EQ(event.text.size(), 1024U);
}

TEST(Transport, AMalformedEndpointIsOneClearError) {
  NavSubscriber nav("tcp://127.0.0.1:70000");
  ASSERT_TRUE(nav.error());
  EXPECT_EQ(nav.error()->message,
            "endpoint tcp://127.0.0.1:70000: expected tcp://HOST:PORT with a port from 1 to 65531");
  EXPECT_TRUE(nav.wait(milliseconds(0)).error);
  EXPECT_EQ(nav.velocity(), Velocity{});
}

TEST(Transport, APublisherOfAnotherVersionIsOneClearError) {
  const TemporaryEndpoint endpoint;
  Encoder encoder;
  const auto part = encoder.encode(walking(1));
  std::vector<std::byte> later(part.begin(), part.end());
  later[7] = std::byte{kSchemaVersion + 1};
  void* context = zmq_ctx_new();
  void* publisher = zmq_socket(context, ZMQ_PUB);
  ASSERT_EQ(zmq_bind(publisher, endpoint.uri().c_str()), 0);
  {
    NavSubscriber nav(endpoint.uri());
    EXPECT_TRUE(repeat_until([&] { zmq_send(publisher, later.data(), later.size(), 0); }, [&] { return nav.error(); }));
    EXPECT_EQ(nav.error()->message,
              "message arm.nav: schema version 2 where this program speaks version 1; update the older side");
    EXPECT_EQ(nav.velocity(), Velocity{});
  }
  zmq_close(publisher);
  zmq_ctx_term(context);
}

TEST(Transport, WorksOverTcp) {
  auto bound = publisher_over_tcp();
  if (!bound) GTEST_SKIP() << "no free TCP ports";
  auto& [uri, publisher] = *bound;
  const auto second = Publisher::bind(uri);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().message, uri + ": already in use; stop the program that has it or choose another endpoint");
  NavSubscriber nav(uri);
  NavigationMessage message = walking(0.5);
  EXPECT_TRUE(repeat_until([&, &publisher = publisher] { publisher.publish_navigation(message); },
                           [&] { return nav.navigation(); }));
}

/// A publisher in a process of its own that publishes until it is stopped or killed.
class PublisherProcess {
 public:
  explicit PublisherProcess(const std::string& uri) {
    int ready[2];
    if (::pipe(ready) != 0) std::abort();
    child_ = ::fork();
    if (child_ == 0) {
      auto publisher = Publisher::bind(uri);
      const char answer = publisher ? 'y' : 'n';
      if (::write(ready[1], &answer, 1) != 1 || !publisher) ::_exit(1);
      for (NavigationMessage message = walking(0.25);; std::this_thread::sleep_for(milliseconds(5))) {
        publisher->publish_navigation(message);
      }
    }
    char answer = 'n';
    running_ = ::read(ready[0], &answer, 1) == 1 && answer == 'y';
    ::close(ready[0]);
    ::close(ready[1]);
  }
  ~PublisherProcess() { kill(); }
  PublisherProcess(const PublisherProcess&) = delete;
  PublisherProcess& operator=(const PublisherProcess&) = delete;

  [[nodiscard]] bool running() const { return running_; }
  void kill() {
    if (child_ <= 0) return;
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
    child_ = -1;
  }

 private:
  pid_t child_ = -1;
  bool running_ = false;
};

TEST(Endpoint, InUseByALiveProcessIsRefusedInOneLineAndStaysAlive) {
  const TemporaryEndpoint endpoint;
  const PublisherProcess other(endpoint.uri());
  ASSERT_TRUE(other.running());
  const auto second = Publisher::bind(endpoint.uri());
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().message,
            endpoint.uri() + ": already in use; stop the program that has it or choose another endpoint");
  NavSubscriber nav(endpoint.uri());
  EXPECT_TRUE(repeat_until([] {}, [&] { return nav.velocity() == Velocity{0.25, 0}; }));
}

TEST(Endpoint, OfAKilledProcessIsTakenOver) {
  const TemporaryEndpoint endpoint;
  PublisherProcess other(endpoint.uri());
  ASSERT_TRUE(other.running());
  other.kill();
  ASSERT_TRUE(std::filesystem::exists(endpoint.path())) << "the killed process left no socket to trip over";
  const auto second = Publisher::bind(endpoint.uri());
  EXPECT_TRUE(second) << second.error().message;
}

TEST(Endpoint, IsFreeAgainWhenItsPublisherGoes) {
  const TemporaryEndpoint endpoint;
  for (int life = 0; life < 3; ++life) {
    const auto publisher = Publisher::bind(endpoint.uri());
    ASSERT_TRUE(publisher) << publisher.error().message;
    EXPECT_FALSE(Publisher::bind(endpoint.uri())) << "a second one in the same process";
  }
  EXPECT_TRUE(std::filesystem::is_empty(endpoint.path().parent_path())) << "sockets and locks go with their publisher";
}

TEST(Endpoint, AFileThatIsNoSocketIsLeftAlone) {
  const TemporaryEndpoint endpoint;
  std::ofstream(endpoint.path()) << "precious";
  const auto publisher = Publisher::bind(endpoint.uri());
  ASSERT_FALSE(publisher);
  EXPECT_EQ(publisher.error().message,
            endpoint.uri() + ": a file that is no socket stands there; choose another endpoint");
  EXPECT_EQ(std::filesystem::file_size(endpoint.path()), 8U);
}

TEST(Endpoint, AMissingDirectoryIsNamedSo) {
  const TemporaryEndpoint endpoint;
  const auto publisher = Publisher::bind(endpoint.uri() + "/deeper/nav");
  ASSERT_FALSE(publisher);
  EXPECT_EQ(publisher.error().message,
            endpoint.uri() + "/deeper/nav: its directory does not exist; create it or choose another endpoint");
}

TEST(Endpoint, SiblingsAreDerivedFromTheBase) {
  const auto ipc = endpoints_of("ipc:///run/armature/nav");
  ASSERT_TRUE(ipc);
  EXPECT_EQ(ipc->navigation, "ipc:///run/armature/nav");
  EXPECT_EQ(ipc->control, "ipc:///run/armature/nav.control");
  const auto tcp = endpoints_of("tcp://*:5550");
  ASSERT_TRUE(tcp);
  EXPECT_EQ(tcp->skeleton, "tcp://*:5551");
  EXPECT_EQ(tcp->events, "tcp://*:5552");
  EXPECT_EQ(tcp->feed, "tcp://*:5553");
  EXPECT_EQ(tcp->control, "tcp://*:5554");
}

TEST(Endpoint, WhatHasNoSiblingsIsRefused) {
  for (const char* base : {"", "nav", "ipc://", "ipc://*", "ipc:///run/", "tcp://host", "tcp://:5550", "tcp://host:0",
                           "tcp://host:65532", "tcp://host:12x", "tcp://host:", "udp://host:5550"}) {
    EXPECT_FALSE(endpoints_of(base)) << base;
  }
  EXPECT_FALSE(endpoints_of("ipc:///" + std::string(120, 'a')));
  EXPECT_TRUE(endpoints_of("ipc:///" + std::string(96, 'a')));
}

}  // namespace
}  // namespace armature::navproto
