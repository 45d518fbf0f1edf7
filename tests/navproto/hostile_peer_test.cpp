#include <array>
#include <cstring>
#include <thread>
#include <vector>

#include <armature/navproto/control.h>
#include <armature/navproto/feed.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zmq.h>

#include "tests/navproto/transport_fixture.h"

namespace armature::navproto {
namespace {

constexpr std::array<const char*, 5> kSiblings = {"", ".skeleton", ".events", ".feed", ".control"};

/// What a kernel holds between two ends at most, and then some.
constexpr std::size_t kSocketBuffers = 2'000'000;

int connected_to(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
  const int peer = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const timeval patience{.tv_sec = kPatience.count() / 1000, .tv_usec = 0};
  ::setsockopt(peer, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  ::setsockopt(peer, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
  EXPECT_EQ(::connect(peer, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0) << path;
  return peer;
}

/// A peer that speaks ZMTP 3.0 (RFC 23) by hand, as nobody of ours would.
class RawPeer {
 public:
  explicit RawPeer(const std::string& path) : socket_(connected_to(path)) {
    const std::string type = path.ends_with(".control") ? "DEALER" : "SUB";
    std::string said = std::string("\xff\0\0\0\0\0\0\0\x01\x7f\x03\0", 12) + "NULL";
    said.resize(64);
    const std::string ready = std::string("\x05READY\x0bSocket-Type\0\0\0", 21) + static_cast<char>(type.size()) + type;
    said += '\x04' + (static_cast<char>(ready.size()) + ready);
    EXPECT_TRUE(say(said));
  }
  ~RawPeer() { ::close(socket_); }
  RawPeer(const RawPeer&) = delete;
  RawPeer& operator=(const RawPeer&) = delete;

  bool say(const std::string& bytes) const {
    return ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size());
  }
  /// How much of it is taken before it is sent away.
  [[nodiscard]] std::size_t say_without_end(const std::function<std::string(int)>& words) const {
    std::size_t taken = 0;
    for (int i = 0; taken <= kSocketBuffers; ++i) {
      const std::string next = words(i);
      if (!say(next)) break;
      taken += next.size();
    }
    return taken;
  }
  [[nodiscard]] bool is_sent_away() const {
    std::array<char, 4096> heard{};
    ssize_t got = 1;
    while (got > 0) got = ::recv(socket_, heard.data(), heard.size(), 0);
    return got == 0 || errno == ECONNRESET;
  }

 private:
  int socket_;
};

/// Everything that listens, and a subscriber who must notice nothing of what others do.
class HostilePeer : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(publisher_ && feed_ && control_);
    ASSERT_TRUE(hears());
  }
  void TearDown() override { EXPECT_TRUE(hears()) << "the others were disturbed"; }

  [[nodiscard]] std::string path(const char* sibling) const { return endpoint_.path().string() + sibling; }

  bool hears() {
    NavigationMessage message = walking(0.5);
    std::uint64_t before = publisher_->counters().sent;
    return repeat_until([&] { publisher_->publish_navigation(message); },
                        [&] { return honest_.navigation() && honest_.navigation()->header.sequence > before; });
  }

  TemporaryEndpoint endpoint_;
  Expected<Publisher> publisher_ = Publisher::bind(endpoint_.uri());
  Expected<FeedPublisher> feed_ = FeedPublisher::bind(endpoint_.uri());
  Expected<ControlServer> control_ = ControlServer::bind(endpoint_.uri());
  NavSubscriber honest_{endpoint_.uri()};
};

TEST_F(HostilePeer, WhoAnnouncesAHugePartIsSentAway) {
  for (const char* sibling : kSiblings) {
    const RawPeer peer(path(sibling));
    ASSERT_TRUE(peer.say(std::string("\x02\0\0\0\0\x01\0\0\0", 9)));  // 16 MiB follow
    EXPECT_TRUE(peer.is_sent_away()) << path(sibling);
  }
}

TEST_F(HostilePeer, WhoNeverEndsAMessageIsSentAway) {
  const std::string large = std::string("\x03\0\0\0\0\0\0\xea\x60", 9) + std::string(60'000, 'x');
  std::string empty;
  for (int i = 0; i < 10'000; ++i) empty += std::string("\x01\0", 2);  // each of them 64 bytes of memory
  for (const char* sibling : kSiblings) {
    for (const std::string& part : {large, empty}) {
      const RawPeer peer(path(sibling));
      EXPECT_LT(peer.say_without_end([&](int) { return part; }), kSocketBuffers) << path(sibling);
    }
  }
}

TEST_F(HostilePeer, WhoSubscribesToEverythingThereIsIsSentAway) {
  for (const char* sibling : {"", ".skeleton", ".events", ".feed"}) {
    const RawPeer peer(path(sibling));
    const auto subscribe = [](int i) {
      const std::string topic = '\x01' + std::to_string(i) + std::string(30, 't');
      return std::string(1, '\0') + static_cast<char>(topic.size()) + topic;
    };
    EXPECT_LT(peer.say_without_end(subscribe), kSocketBuffers) << path(sibling);
  }
}

TEST_F(HostilePeer, WhoComesOnceTooOftenIsSentAwayAndNobodyElse) {
  std::vector<int> peers;
  peers.reserve(100);
  for (int i = 0; i < 100; ++i) peers.push_back(connected_to(path("")));
  std::array<char, 64> heard{};
  EXPECT_EQ(::recv(peers.back(), heard.data(), heard.size(), 0), 0);
  EXPECT_GT(::recv(peers.front(), heard.data(), heard.size(), 0), 0);
  for (const int peer : peers) ::close(peer);
  // Where somebody has left there is room again.
  NavSubscriber late(endpoint_.uri());
  NavigationMessage message = walking(0.5);
  EXPECT_TRUE(repeat_until([&] { publisher_->publish_navigation(message); }, [&] { return late.navigation(); }));
}

// libzmq's own listener of ipc aborts when accept() finds no descriptor left.
TEST(HostilePeers, ThatLeaveNoDescriptorEndNobody) {
  const TemporaryEndpoint endpoint;
  int go[2], come[2];
  ASSERT_TRUE(::pipe(go) == 0 && ::pipe(come) == 0);
  char word = 'x';
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(go[1]);  // so that it ends when we do
    if (::read(go[0], &word, 1) != 1) ::_exit(1);
    for (int i = 0; i < 90; ++i) {
      for (const char* sibling : {"", ".skeleton", ".events"}) connected_to(endpoint.path().string() + sibling);
    }
    if (::write(come[1], &word, 1) != 1 || ::read(go[0], &word, 1) != 1) ::_exit(1);
    ::_exit(0);
  }
  auto publisher = Publisher::bind(endpoint.uri());
  ASSERT_TRUE(publisher);
  NavSubscriber honest(endpoint.uri());
  NavigationMessage message = walking(0.5);
  const auto publish = [&] { publisher->publish_navigation(message); };
  ASSERT_TRUE(repeat_until(publish, [&] { return honest.navigation(); }));
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const int used = ::dup(0);
  ::close(used);
  const rlimit few{static_cast<rlim_t>(used) + 60, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &few), 0);
  ASSERT_EQ(::write(go[1], &word, 1), 1);
  ASSERT_EQ(::read(come[0], &word, 1), 1);
  const auto sent = publisher->counters().sent;
  EXPECT_TRUE(repeat_until(publish, [&] { return honest.navigation()->header.sequence > sent + 100; }));
  ASSERT_EQ(::write(go[1], &word, 1), 1);
  ::waitpid(child, nullptr, 0);
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
  for (const int end : {go[0], go[1], come[0], come[1]}) ::close(end);
}

// Whoever is listed may be broken into all the same. What it says is encrypted, how much it says is not.
TEST(HostilePeers, WithAKeyAreSentAwayToo) {
  const std::string endpoint = "tcp://127.0.0.1:24753";
  const auto server = make_key_pair(), listed = make_key_pair();
  ASSERT_TRUE(server && listed);
  PublisherOptions options;
  options.curve = CurveServer{*server, {{listed->public_key, "listed"}}};
  auto publisher = Publisher::bind(endpoint, options);
  ASSERT_TRUE(publisher) << publisher.error().message;
  NavSubscriber honest(endpoint, {.curve = CurveClient{server->public_key, *listed}});
  NavigationMessage message = walking(0.5);
  const auto publish = [&] { publisher->publish_navigation(message); };
  ASSERT_TRUE(repeat_until(publish, [&] { return honest.navigation(); }));

  void* context = zmq_ctx_new();
  void* peer = zmq_socket(context, ZMQ_XSUB);  // what it sends goes up as it is
  zmq_setsockopt(peer, ZMQ_CURVE_SERVERKEY, server->public_key.data(), server->public_key.size());
  zmq_setsockopt(peer, ZMQ_CURVE_PUBLICKEY, listed->public_key.data(), listed->public_key.size());
  zmq_setsockopt(peer, ZMQ_CURVE_SECRETKEY, listed->secret_key.data(), listed->secret_key.size());
  const int no_linger = 0;
  zmq_setsockopt(peer, ZMQ_LINGER, &no_linger, sizeof no_linger);
  zmq_socket_monitor(peer, "inproc://watch", ZMQ_EVENT_DISCONNECTED);
  void* watch = zmq_socket(context, ZMQ_PAIR);
  ASSERT_EQ(zmq_connect(watch, "inproc://watch"), 0);
  ASSERT_EQ(zmq_connect(peer, endpoint.c_str()), 0);
  const std::string part(1000, 'x');
  std::array<char, 256> told{};
  const auto talk = [&] {
    publish();
    for (int i = 0; i < 10; ++i) zmq_send(peer, part.data(), part.size(), ZMQ_DONTWAIT);
  };
  EXPECT_TRUE(repeat_until(talk, [&] { return zmq_recv(watch, told.data(), told.size(), ZMQ_DONTWAIT) > 0; }));
  zmq_close(watch);
  zmq_close(peer);
  zmq_ctx_term(context);
  const auto sent = publisher->counters().sent;
  EXPECT_TRUE(repeat_until(publish, [&] { return honest.navigation()->header.sequence > sent; }));
}

}  // namespace
}  // namespace armature::navproto
