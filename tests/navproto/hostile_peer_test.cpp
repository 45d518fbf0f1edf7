#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <thread>
#include <utility>
#include <vector>

#include <armature/navproto/control.h>
#include <armature/navproto/feed.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
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

int patient_socket(int family) {
  const int peer = ::socket(family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const timeval patience{.tv_sec = kPatience.count() / 1000, .tv_usec = 0};
  ::setsockopt(peer, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  ::setsockopt(peer, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
  return peer;
}

int connected_to(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
  const int peer = patient_socket(AF_UNIX);
  EXPECT_EQ(::connect(peer, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0) << path;
  return peer;
}

/// From `host` of 127.0.0.0/8 to a port of 127.0.0.1.
int connected_from(unsigned host, const std::string& uri) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(0x7F000000U + host);
  const int peer = patient_socket(AF_INET);
  EXPECT_EQ(::bind(peer, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(std::stoi(uri.substr(uri.rfind(':') + 1))));
  EXPECT_EQ(::connect(peer, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0) << uri;
  return peer;
}

/// A peer that speaks ZMTP 3.0 (RFC 23) by hand, as nobody of ours would.
class RawPeer {
 public:
  explicit RawPeer(const std::string& path)
      : RawPeer(connected_to(path), path.ends_with(".control") ? "DEALER" : "SUB") {}
  RawPeer(int socket, const std::string& type) : socket_(socket) {
    std::string said = std::string("\xff\0\0\0\0\0\0\0\x01\x7f\x03\0", 12) + "NULL";
    said.resize(64);
    const std::string ready = std::string("\x05READY\x0bSocket-Type\0\0\0", 21) + static_cast<char>(type.size()) + type;
    said += '\x04' + (static_cast<char>(ready.size()) + ready);
    is_in_ = say(said) && hears_ready();
  }
  ~RawPeer() {
    if (socket_ >= 0) ::close(socket_);
  }
  RawPeer(RawPeer&& other) noexcept : socket_(std::exchange(other.socket_, -1)), is_in_(other.is_in_) {}
  RawPeer& operator=(RawPeer&&) = delete;

  /// Whether it was let in: has been greeted, and has shaken hands.
  [[nodiscard]] bool is_in() const { return is_in_; }
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
  [[nodiscard]] bool hears_ready() const {
    std::string heard;
    std::array<char, 256> more{};
    while (heard.find("READY") == std::string::npos) {
      const ssize_t got = ::recv(socket_, more.data(), more.size(), 0);
      if (got <= 0) return false;
      heard.append(more.data(), static_cast<std::size_t>(got));
    }
    return true;
  }

  int socket_;
  bool is_in_ = false;
};

/// How many of so many peers are let in, that say nothing any more.
std::size_t let_in(std::vector<RawPeer>& peers, const std::string& path, int count) {
  std::size_t in = 0;
  for (int i = 0; i < count; ++i) in += peers.emplace_back(path).is_in() ? 1U : 0U;
  return in;
}

/// A process of another user, which does what it is told and says whether it is content. It lives as long as we do.
class AnotherUser {
 public:
  AnotherUser(uid_t user, const std::function<bool()>& task) {
    int come[2];
    if (::pipe(go_) != 0 || ::pipe(come) != 0) std::abort();
    child_ = ::fork();
    if (child_ == 0) {
      ::close(go_[1]);  // so that it ends when we do
      char word = ::setresuid(user, user, user) == 0 && task() ? 'y' : 'n';
      if (::write(come[1], &word, 1) == 1) (void)!::read(go_[0], &word, 1);
      ::_exit(0);
    }
    ::close(come[1]);
    come_ = come[0];
    ::fcntl(come_, F_SETFL, O_NONBLOCK);
  }
  ~AnotherUser() {
    for (const int end : {go_[0], go_[1], come_}) ::close(end);
    ::waitpid(child_, nullptr, 0);
  }
  AnotherUser(const AnotherUser&) = delete;
  AnotherUser& operator=(const AnotherUser&) = delete;

  /// Once it is done.
  [[nodiscard]] bool is_content() const {
    char word = 'n';
    return repeat_until([] {}, [&] { return ::read(come_, &word, 1) == 1; }) && word == 'y';
  }

 private:
  int go_[2]{};
  int come_ = -1;
  pid_t child_ = -1;
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

TEST_F(HostilePeer, WhoNeverShakesHandsIsSentAway) {
  std::vector<int> silent;
  silent.reserve(kSiblings.size());
  for (const char* sibling : kSiblings) silent.push_back(connected_to(path(sibling)));
  for (const int peer : silent) {
    std::array<char, 64> heard{};
    ssize_t got = 1;
    while (got > 0) got = ::recv(peer, heard.data(), heard.size(), 0);
    EXPECT_EQ(got, 0);  // and not -1, which it is where patience has ended
    ::close(peer);
  }
}

TEST_F(HostilePeer, NoUserTakesThePlacesOfTheOthers) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs root, to become others";
  ::chmod(endpoint_.path().parent_path().c_str(), 0777);
  for (const char* sibling : kSiblings) ::chmod(path(sibling).c_str(), 0777);
  constexpr uid_t kGreedy = 65'534, kGreedyToo = 65'533, kModest = 65'532;
  std::vector<RawPeer> taken;
  // The fixture's own subscriber has a place, too.
  const AnotherUser greedy(kGreedy, [&] { return let_in(taken, path(""), 60) == 48; });
  EXPECT_TRUE(greedy.is_content());
  const AnotherUser greedy_too(
      kGreedyToo, [&] { return let_in(taken, path(""), 60) == 23 && let_in(taken, path(".control"), 20) == 8; });
  EXPECT_TRUE(greedy_too.is_content());
  const AnotherUser modest(kModest,
                           [&] { return let_in(taken, path(""), 1) == 0 && let_in(taken, path(".control"), 1) == 1; });
  EXPECT_TRUE(modest.is_content());
  // What is left is ours.
  EXPECT_EQ(let_in(taken, path(""), 30), 24U);
  EXPECT_EQ(let_in(taken, path(".control"), 16), 16U);
}

TEST(HostilePeers, OfOneAddressLeaveRoomForThoseOfOthers) {
  auto bound = publisher_over_tcp();
  if (!bound) GTEST_SKIP() << "no free TCP ports";
  std::vector<RawPeer> peers;
  peers.reserve(60);
  for (int i = 0; i < 60; ++i) peers.emplace_back(connected_from(2, bound->uri), "SUB");
  EXPECT_EQ(std::ranges::count_if(peers, &RawPeer::is_in), 48);
  NavSubscriber honest(bound->uri);
  NavigationMessage message = walking(0.5);
  EXPECT_TRUE(repeat_until([&] { bound->publisher.publish_navigation(message); }, [&] { return honest.navigation(); }));
}

// Peers are carried to a socket by way of /proc, so that its file need not have a name.
TEST(HostilePeers, AreNotLetInWithoutProcAndTheReasonIsTold) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs root, to change the root directory";
  const TemporaryEndpoint endpoint;
  const pid_t child = ::fork();
  if (child == 0) {
    if (::chroot(endpoint.path().parent_path().c_str()) != 0) ::_exit(2);
    const auto publisher = Publisher::bind("ipc:///nav");
    ::_exit(!publisher && publisher.error().message ==
                              "ipc:///nav: peers cannot be let in by way of /: No such file or directory; that takes "
                              "/proc and a folder this user may write to"
                ? 0
                : 1);
  }
  int ended = -1;
  ::waitpid(child, &ended, 0);
  EXPECT_EQ(ended, 0);
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
  const auto server = make_key_pair(), listed = make_key_pair();
  ASSERT_TRUE(server && listed);
  PublisherOptions options;
  options.curve = CurveServer{*server, {{listed->public_key, "listed"}}};
  auto bound = publisher_over_tcp(options);
  if (!bound) GTEST_SKIP() << "no free TCP ports";
  const auto& endpoint = bound->uri;
  Publisher* const publisher = &bound->publisher;
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
