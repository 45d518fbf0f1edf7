#include "navproto/src/socket.h"

#include <cerrno>

#include <sys/stat.h>

namespace armature::navproto {
namespace {

tl::unexpected<Error> refuse(const std::string& endpoint, int error) {
  switch (error) {
    case EADDRINUSE:
      return fail(endpoint + ": already in use; stop the program that has it or choose another endpoint");
    case EACCES: return fail(endpoint + ": permission denied; choose an endpoint this user may create");
    case ENOENT: return fail(endpoint + ": its directory does not exist; create it or choose another endpoint");
    default: return fail(endpoint + ": " + zmq_strerror(error));
  }
}

}  // namespace

Expected<EndpointLock> bind_exclusively(Socket& socket, const std::string& endpoint) {
  auto lock = EndpointLock::take(endpoint);
  if (!lock) return lock;
  keep_alive(socket, endpoint);
  if (zmq_bind(socket.get(), endpoint.c_str()) != 0) return refuse(endpoint, zmq_errno());
  // Its owner and its group may connect, nobody else. (Of an abstract name there is no file.)
  constexpr std::string_view kIpc = "ipc://";
  if (endpoint.starts_with(kIpc)) ::chmod(endpoint.c_str() + kIpc.size(), 0660);
  return lock;
}

Expected<void> connect(Socket& socket, const std::string& endpoint) {
  keep_alive(socket, endpoint);
  if (zmq_connect(socket.get(), endpoint.c_str()) != 0) return refuse(endpoint, zmq_errno());
  return {};
}

void keep_alive(Socket& socket, const std::string& endpoint) {
  if (!endpoint.starts_with("tcp:")) return;
  socket.set(ZMQ_HEARTBEAT_IVL, 1000).set(ZMQ_HEARTBEAT_TIMEOUT, 3000).set(ZMQ_HEARTBEAT_TTL, 3000);
}

ContextHandle make_context() {
  return ContextHandle(zmq_ctx_new());
}

bool poll(std::span<zmq_pollitem_t> items, std::chrono::milliseconds timeout) noexcept {
  return zmq_poll(items.data(), static_cast<int>(items.size()), static_cast<long>(timeout.count())) > 0;
}

}  // namespace armature::navproto
