#include "navproto/src/socket.h"

#include <cerrno>

namespace armature::navproto {

tl::unexpected<Error> refuse(const std::string& endpoint, int error) {
  switch (error) {
    case EADDRINUSE:
      return fail(endpoint + ": already in use; stop the program that has it or choose another endpoint");
    case EACCES: return fail(endpoint + ": permission denied; choose an endpoint this user may create");
    case ENOENT: return fail(endpoint + ": its directory does not exist; create it or choose another endpoint");
    default: return fail(endpoint + ": " + zmq_strerror(error) + "; choose another endpoint");
  }
}

Expected<void> connect(Socket& socket, const std::string& endpoint) {
  // The kernel's way, by which a subscriber says nothing: ZeroMQ's heartbeats would use up what it may say.
  if (endpoint.starts_with("tcp:")) {
    socket.set(ZMQ_TCP_KEEPALIVE, 1).set(ZMQ_TCP_KEEPALIVE_IDLE, 1).set(ZMQ_TCP_KEEPALIVE_INTVL, 1);
    socket.set(ZMQ_TCP_KEEPALIVE_CNT, 3).set(ZMQ_TCP_MAXRT, 3000);
  }
  if (zmq_connect(socket.get(), endpoint.c_str()) != 0) return refuse(endpoint, zmq_errno());
  return {};
}

ContextHandle make_context() {
  return ContextHandle(zmq_ctx_new());
}

bool poll(std::span<zmq_pollitem_t> items, std::chrono::milliseconds timeout) noexcept {
  return zmq_poll(items.data(), static_cast<int>(items.size()), static_cast<long>(timeout.count())) > 0;
}

}  // namespace armature::navproto
