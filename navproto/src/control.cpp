#include <algorithm>
#include <array>

#include <armature/navproto/codec.h>
#include <armature/navproto/control.h>
#include <armature/navproto/endpoints.h>
#include <unistd.h>

#include "navproto/src/entrance.h"
#include "navproto/src/session.h"
#include "navproto/src/socket.h"
#include "navproto/src/transport.h"
#include "navproto/src/wire.h"

namespace armature::navproto {

namespace {

/// Requests of a client that wait for us.
constexpr int kQueue = 4;

/// Replies that wait for their client. ZeroMQ drops what exceeds them, and hears late of what has gone: only between
/// our rounds of kMostAtATime, so that a client that is quick to ask again would miss its fifth reply with four.
constexpr int kReplies = 4 * kMostAtATime;

}  // namespace

struct ControlServer::Impl {
  Entrance entrance{kOfClients};  // first, so that it outlives the context
  std::uint64_t refused = 0;
  ContextHandle context = make_context();
  // Of those who may only ask, and of those who may change something: a peer's user says to which it is let in.
  std::array<Socket, 2> sockets{Socket(context.get(), ZMQ_ROUTER), Socket(context.get(), ZMQ_ROUTER)};
  Encoder encoder;
  Part peer;
  Part payload;

  [[nodiscard]] ControlReply answer(const Handler& handler, bool may_change) {
    const auto request = decode<ControlRequest>(payload.bytes());
    ControlReply reply;
    if (!request) {
      ++refused;
      reply.error = request.error().message;
    } else if (request->kind != RequestKind::Status && !may_change) {
      ++refused;
      reply.id = request->id;
      reply.error = "refused: only root, the daemon's own user and those in control.uids may change anything";
    } else {
      reply = handler(*request);
      reply.id = request->id;
    }
    reply.error = sanitised(std::move(reply.error));
    reply.health.version = sanitised(std::move(reply.health.version));
    reply.health.source = sanitised(std::move(reply.health.source));
    reply.health.source_trouble = sanitised(std::move(reply.health.source_trouble));
    if (const auto complaint = check(reply)) {
      ControlReply apology;
      apology.id = reply.id;
      apology.error = "the reply does not hold to the schema: " + complaint->message;
      return apology;
    }
    return reply;
  }

  /// A request is the peer's identity and one part; whatever else a peer sends is read and forgotten.
  [[nodiscard]] bool receive_request(Socket& socket, bool& is_request) {
    if (!socket.receive(peer)) return false;
    is_request = peer.more() && socket.receive(payload) && !payload.more();
    Part rest;
    bool more = is_request ? false : (peer.more() && payload.more());
    while (more && socket.receive(rest)) more = rest.more();
    return true;
  }
};

Expected<ControlServer> ControlServer::bind(std::string_view endpoint, ControlServerOptions options) {
  const auto endpoints = endpoints_of(endpoint);
  if (!endpoints) return tl::unexpected(endpoints.error());
  if (!endpoints->control.starts_with(kIpc) && !options.allow_tcp) {
    return fail("control " + endpoints->control + ": only ipc:// unless tcp is allowed expressly");
  }
  auto impl = std::make_unique<Impl>();
  for (Socket& socket : impl->sockets) socket.set(ZMQ_LINGER, 250).set(ZMQ_RCVHWM, kQueue).set(ZMQ_SNDHWM, kReplies);
  const auto may_change = [allowed = std::move(options.allowed_uids)](uid_t user) -> std::size_t {
    return user == 0 || user == ::geteuid() || std::ranges::count(allowed, user) > 0 ? 1 : 0;
  };
  auto& [asking, changing] = impl->sockets;
  // Whoever comes over tcp may change things: that was allowed expressly.
  auto bound = endpoints->control.starts_with(kIpc)
                   ? impl->entrance.open(endpoints->control, std::array{&asking, &changing}, may_change)
                   : impl->entrance.open(endpoints->control, changing);
  if (!bound) return tl::unexpected(bound.error());
  return ControlServer(std::move(impl));
}

ControlServer::ControlServer(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
ControlServer::~ControlServer() = default;
ControlServer::ControlServer(ControlServer&&) noexcept = default;
ControlServer& ControlServer::operator=(ControlServer&&) noexcept = default;

int ControlServer::serve(const Handler& handler, std::chrono::milliseconds timeout) {
  auto& [asking, changing] = impl_->sockets;
  if (timeout.count() > 0) {
    std::array<zmq_pollitem_t, 2> items{{{asking.get(), 0, ZMQ_POLLIN, 0}, {changing.get(), 0, ZMQ_POLLIN, 0}}};
    if (!poll(items, timeout)) return 0;
  }
  int answered = 0;
  for (Socket* socket : {&changing, &asking}) {
    bool is_request = false;
    for (int taken = 0; taken < kMostAtATime && impl_->receive_request(*socket, is_request); ++taken) {
      if (!is_request) continue;
      const ControlReply reply = impl_->answer(handler, socket == &changing);
      socket->send(impl_->peer.bytes(), ZMQ_SNDMORE);
      socket->send(impl_->encoder.encode(reply));
      ++answered;
    }
  }
  return answered;
}

std::uint64_t ControlServer::refused() const noexcept {
  return impl_->refused;
}

struct ControlClient::Impl {
  std::string endpoint;
  ContextHandle context = make_context();
  Socket socket{context.get(), ZMQ_DEALER};
  Encoder encoder;
  Part part;
  std::uint64_t last_id = random_session_id();

  /// Waits for `event` until `deadline`.
  bool wait(short event, std::chrono::steady_clock::time_point deadline) {
    for (;;) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
      if (left.count() <= 0) return false;
      std::array<zmq_pollitem_t, 1> items{{{socket.get(), 0, event, 0}}};
      if (poll(items, left)) return true;
    }
  }
};

Expected<ControlClient> ControlClient::connect(std::string_view endpoint) {
  const auto endpoints = endpoints_of(endpoint);
  if (!endpoints) return tl::unexpected(endpoints.error());
  auto impl = std::make_unique<Impl>();
  impl->endpoint = endpoints->control;
  // IMMEDIATE: a request must not lie in wait for a server that starts after its client has given up.
  impl->socket.set(ZMQ_LINGER, 0).set(ZMQ_IMMEDIATE, 1).set(ZMQ_RECONNECT_IVL, 50).set(ZMQ_RECONNECT_IVL_MAX, 400);
  if (auto connected = navproto::connect(impl->socket, impl->endpoint); !connected) {
    return tl::unexpected(connected.error());
  }
  return ControlClient(std::move(impl));
}

ControlClient::ControlClient(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
ControlClient::~ControlClient() = default;
ControlClient::ControlClient(ControlClient&&) noexcept = default;
ControlClient& ControlClient::operator=(ControlClient&&) noexcept = default;

Expected<ControlReply> ControlClient::request(ControlRequest request, std::chrono::milliseconds timeout) {
  request.id = ++impl_->last_id;
  if (const auto complaint = check(request)) return fail("request: " + complaint->message);
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  const auto silence = [&]() -> Expected<ControlReply> {
    if (const auto allowed = may_connect(impl_->endpoint); !allowed) return tl::unexpected(allowed.error());
    return fail(impl_->endpoint + ": no answer within " + std::to_string(timeout.count()) +
                " ms; is armatured running there?");
  };
  while (impl_->socket.receive(impl_->part)) {
    // Replies to requests that were given up.
  }
  const auto part = impl_->encoder.encode(request);
  do {
    if (!impl_->wait(ZMQ_POLLOUT, deadline)) return silence();
  } while (!impl_->socket.send(part));
  while (impl_->wait(ZMQ_POLLIN, deadline)) {
    if (!impl_->socket.receive(impl_->part)) continue;
    auto reply = decode<ControlReply>(impl_->part.bytes());
    if (!reply) return fail(impl_->endpoint + ": " + reply.error().message);
    if (reply->id == request.id) return reply;
    // A request the server could not read has no id to repeat.
    if (reply->id == 0 && !reply->error.empty()) return reply;
  }
  return silence();
}

}  // namespace armature::navproto
