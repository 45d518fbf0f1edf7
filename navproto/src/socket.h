#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <armature/navproto/codec.h>
#include <armature/navproto/error.h>
#include <zmq.h>

// ZeroMQ behind types that own what they open. Private: nothing installed includes this.

namespace armature::navproto {

/// So many messages of a socket in a row and no more: whoever floods us does not keep the caller from other sockets, or
/// from stopping.
inline constexpr int kMostAtATime = 8;

struct CloseContext {
  void operator()(void* context) const noexcept { zmq_ctx_term(context); }
};
struct CloseSocket {
  void operator()(void* socket) const noexcept { zmq_close(socket); }
};
using ContextHandle = std::unique_ptr<void, CloseContext>;

/// A received part. Its bytes live until the next receive into it.
class Part {
 public:
  Part() { zmq_msg_init(&message_); }
  ~Part() { zmq_msg_close(&message_); }
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;

  [[nodiscard]] std::span<const std::byte> bytes() const noexcept {
    auto* message = const_cast<zmq_msg_t*>(&message_);
    return {static_cast<const std::byte*>(zmq_msg_data(message)), zmq_msg_size(message)};
  }
  [[nodiscard]] bool more() const noexcept { return zmq_msg_more(&message_) != 0; }
  [[nodiscard]] zmq_msg_t* get() noexcept { return &message_; }

 private:
  zmq_msg_t message_;
};

/// A socket that never waits by itself: send and receive report at once what they could do. A peer that announces a
/// part of more than kMaxMessageBytes, or what set_max_bytes() says, is sent away before memory is taken for it. How
/// many parts a message has ZeroMQ does not bound: whoever lets peers in does (Entrance).
class Socket {
 public:
  Socket() = default;
  Socket(void* context, int type) : handle_(zmq_socket(context, type)) { set_max_bytes(kMaxMessageBytes); }

  Socket& set(int option, int value) {
    zmq_setsockopt(handle_.get(), option, &value, sizeof value);
    return *this;
  }
  Socket& set_max_bytes(std::size_t bytes) {
    const auto value = static_cast<std::int64_t>(bytes);
    zmq_setsockopt(handle_.get(), ZMQ_MAXMSGSIZE, &value, sizeof value);
    return *this;
  }
  void subscribe(std::string_view prefix) {
    zmq_setsockopt(handle_.get(), ZMQ_SUBSCRIBE, prefix.data(), prefix.size());
  }

  /// Whether it was queued. A subscriber's full queue is no failure; nobody there to take a request is.
  bool send(std::span<const std::byte> bytes, int flags = 0) noexcept {
    return zmq_send(handle_.get(), bytes.data(), bytes.size(), flags | ZMQ_DONTWAIT) >= 0;
  }
  /// Whether a part was there.
  bool receive(Part& part) noexcept { return zmq_msg_recv(part.get(), handle_.get(), ZMQ_DONTWAIT) >= 0; }

  [[nodiscard]] void* get() const noexcept { return handle_.get(); }

 private:
  std::unique_ptr<void, CloseSocket> handle_;
};

/// Connects, whether or not somebody is there yet. Dead TCP peers are found in seconds.
[[nodiscard]] Expected<void> connect(Socket& socket, const std::string& endpoint);

/// Why an endpoint cannot be had, by errno.
[[nodiscard]] tl::unexpected<Error> refuse(const std::string& endpoint, int error);

[[nodiscard]] ContextHandle make_context();

/// Waits until one of the sockets has something to read or has room to write, as asked.
bool poll(std::span<zmq_pollitem_t> items, std::chrono::milliseconds timeout) noexcept;

}  // namespace armature::navproto
