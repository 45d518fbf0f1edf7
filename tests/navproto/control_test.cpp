#include <thread>

#include <armature/navproto/codec.h>
#include <armature/navproto/control.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zmq.h>

#include "tests/navproto/sample_messages.h"
#include "tests/navproto/transport_fixture.h"
#include "tests/support/temporary_directory.h"

namespace armature::navproto {
namespace {

using std::chrono::milliseconds;

/// A server that answers from a thread of its own until it goes.
class AnsweringServer {
 public:
  AnsweringServer(ControlServer server, ControlServer::Handler handler)
      : thread_([server = std::move(server), handler = std::move(handler)](const std::stop_token& stop) mutable {
          while (!stop.stop_requested()) server.serve(handler, milliseconds(5));
        }) {}

 private:
  std::jthread thread_;
};

TEST(Control, ARequestIsAnswered) {
  const TemporaryEndpoint endpoint;
  auto server = ControlServer::bind(endpoint.uri());
  ASSERT_TRUE(server) << server.error().message;
  const AnsweringServer answering(*std::move(server), [](const ControlRequest& request) {
    ControlReply reply = sample::reply();
    reply.error = request.kind == RequestKind::Set ? "" : "not asked to set";
    reply.settings = request.settings;
    return reply;
  });
  auto client = ControlClient::connect(endpoint.uri());
  ASSERT_TRUE(client) << client.error().message;
  for (int i = 0; i < 3; ++i) {
    const auto reply = client->request(sample::request(), kPatience);
    ASSERT_TRUE(reply) << reply.error().message;
    EXPECT_EQ(reply->error, "");
    EXPECT_EQ(reply->settings, sample::settings());
    EXPECT_EQ(reply->health.source, sample::health().source);
  }
  const auto refused = client->request({.kind = RequestKind::Save}, kPatience);
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->error, "not asked to set");
}

TEST(Control, AClientMayAskForAsLongAsItListens) {
  const TemporaryEndpoint endpoint;
  auto server = ControlServer::bind(endpoint.uri());
  ASSERT_TRUE(server);
  const AnsweringServer answering(*std::move(server), [](const ControlRequest&) { return sample::reply(); });
  auto client = ControlClient::connect(endpoint.uri());
  ASSERT_TRUE(client);
  // 100 KB of requests; 16 KiB without an answer would be too many.
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(client->request(sample::request(), kPatience)) << "request " << i;
}

TEST(Control, NoServerIsOneClearError) {
  const TemporaryEndpoint endpoint;
  auto client = ControlClient::connect(endpoint.uri());
  ASSERT_TRUE(client);
  const auto reply = client->request({}, milliseconds(20));
  ASSERT_FALSE(reply);
  EXPECT_EQ(reply.error().message, endpoint.uri() + ".control: no answer within 20 ms; is armatured running there?");
}

TEST(Control, ARequestThatWasGivenUpIsNotCarriedOutLater) {
  const TemporaryEndpoint endpoint;
  auto client = ControlClient::connect(endpoint.uri());
  ASSERT_TRUE(client);
  EXPECT_FALSE(client->request({.kind = RequestKind::Save}, milliseconds(10)));
  auto server = ControlServer::bind(endpoint.uri());
  ASSERT_TRUE(server);
  std::vector<RequestKind> seen;
  std::atomic<bool> done = false;
  std::jthread asking([&] {
    EXPECT_TRUE(client->request({.kind = RequestKind::Status}, kPatience));
    done = true;
  });
  ASSERT_TRUE(repeat_until(
      [&] {
        server->serve(
            [&](const ControlRequest& request) {
              seen.push_back(request.kind);
              return ControlReply{};
            },
            milliseconds(5));
      },
      [&] { return done.load(); }));
  EXPECT_EQ(seen, std::vector{RequestKind::Status});
}

TEST(Control, ALateReplyIsNotTakenForTheNextOne) {
  const TemporaryEndpoint endpoint;
  auto server = ControlServer::bind(endpoint.uri());
  ASSERT_TRUE(server);
  std::atomic<int> asked = 0;
  const AnsweringServer answering(*std::move(server), [&](const ControlRequest& request) {
    if (++asked == 1) std::this_thread::sleep_for(milliseconds(100));
    ControlReply reply;
    reply.user_id = request.kind == RequestKind::Status ? 1 : 2;
    return reply;
  });
  auto client = ControlClient::connect(endpoint.uri());
  ASSERT_TRUE(client);
  ASSERT_TRUE(repeat_until(
      [] {}, [&] { return asked > 0 || !client->request({.kind = RequestKind::Status}, milliseconds(20)); }));
  const auto reply = client->request({.kind = RequestKind::Rerest}, kPatience);
  ASSERT_TRUE(reply) << reply.error().message;
  EXPECT_EQ(reply->user_id, 2U);
}

TEST(Control, WhatIsNoRequestIsAnsweredWithoutTheHandlerOrForgotten) {
  const TemporaryEndpoint endpoint;
  auto server = ControlServer::bind(endpoint.uri());
  ASSERT_TRUE(server);
  void* context = zmq_ctx_new();
  void* dealer = zmq_socket(context, ZMQ_DEALER);
  const int patience_ms = static_cast<int>(kPatience.count());
  zmq_setsockopt(dealer, ZMQ_RCVTIMEO, &patience_ms, sizeof patience_ms);
  ASSERT_EQ(zmq_connect(dealer, (endpoint.uri() + ".control").c_str()), 0);
  zmq_send(dealer, "a", 1, ZMQ_SNDMORE);
  zmq_send(dealer, "b", 1, ZMQ_SNDMORE);
  zmq_send(dealer, "c", 1, 0);
  zmq_send(dealer, "nonsense", 8, 0);
  int calls = 0;
  int answered = 0;
  EXPECT_TRUE(repeat_until(
      [&] {
        answered += server->serve(
            [&](const ControlRequest&) {
              ++calls;
              return ControlReply{};
            },
            milliseconds(5));
      },
      [&] { return answered > 0; }));
  std::vector<std::byte> bytes(4096);
  const int size = zmq_recv(dealer, bytes.data(), bytes.size(), 0);
  ASSERT_GT(size, 0);
  const auto reply = decode<ControlReply>(std::span(bytes).first(static_cast<std::size_t>(size)));
  ASSERT_TRUE(reply) << reply.error().message;
  EXPECT_EQ(reply->error, "message arm.req: the part does not begin so");
  EXPECT_EQ(calls, 0);
  const int no_linger = 0;
  zmq_setsockopt(dealer, ZMQ_LINGER, &no_linger, sizeof no_linger);
  zmq_close(dealer);
  zmq_ctx_term(context);
}

TEST(Control, AnotherUserMayAskAndNotChange) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs root, to become somebody else";
  const test::TemporaryDirectory directory;
  const std::string endpoint = "ipc://" + (directory.path() / "nav").string();
  ::chmod(directory.path().c_str(), 0777);
  auto server = ControlServer::bind(endpoint);
  ASSERT_TRUE(server);
  ::chmod((directory.path() / "nav.control").c_str(), 0777);
  const pid_t child = ::fork();
  if (child == 0) {
    if (::setuid(65534) != 0) ::_exit(3);
    auto client = ControlClient::connect(endpoint);
    const auto status = client->request({.kind = RequestKind::Status}, kPatience);
    const auto save = client->request({.kind = RequestKind::Save}, kPatience);
    ::_exit(status && status->error.empty() && save && save->error.starts_with("refused:") ? 0 : 1);
  }
  std::vector<RequestKind> seen;
  int ended = -1;
  EXPECT_TRUE(repeat_until(
      [&] {
        server->serve(
            [&](const ControlRequest& request) {
              seen.push_back(request.kind);
              return ControlReply{};
            },
            milliseconds(5));
      },
      [&] { return ::waitpid(child, &ended, WNOHANG) == child; }));
  EXPECT_EQ(ended, 0);
  EXPECT_EQ(seen, std::vector{RequestKind::Status});
  EXPECT_EQ(server->refused(), 1U);
}

TEST(Control, StaysOnThisMachineUnlessToldOtherwise) {
  const auto server = ControlServer::bind("tcp://127.0.0.1:20950");
  ASSERT_FALSE(server);
  EXPECT_EQ(server.error().message, "control tcp://127.0.0.1:20954: only ipc:// unless tcp is allowed expressly");
}

TEST(Control, ARequestOutOfItsRangesIsNotSent) {
  const TemporaryEndpoint endpoint;
  auto client = ControlClient::connect(endpoint.uri());
  ASSERT_TRUE(client);
  ControlRequest request{.kind = RequestKind::Set};
  request.settings.max_walk_m_s = -1.0F;
  const auto reply = client->request(request, kPatience);
  ASSERT_FALSE(reply);
  EXPECT_EQ(reply.error().message, "request: settings.max_walk_m_s: must be above 0 and at most 100");
}

}  // namespace
}  // namespace armature::navproto
