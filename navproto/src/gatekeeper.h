#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <thread>

#include <armature/navproto/keys.h>

#include "navproto/src/socket.h"

namespace armature::navproto {

/// Answers ZeroMQ's question whether a peer may come in (ZAP, RFC 27) for every CURVE socket of a context: whose key is
/// on the list, nobody else. On a thread of its own, so that no peer at the door holds up a publisher.
class Gatekeeper {
 public:
  /// Starts before the sockets it guards are bound, and ends before the context.
  Gatekeeper(void* context, const CurveServer& curve);
  ~Gatekeeper();
  Gatekeeper(const Gatekeeper&) = delete;
  Gatekeeper& operator=(const Gatekeeper&) = delete;

  /// Whether somebody stands at the door. If not, ZeroMQ would let everybody in who speaks CURVE: nothing may be bound.
  [[nodiscard]] bool at_the_door() const noexcept { return thread_.joinable(); }

  /// Makes `socket` one that only listed keys may connect to. Before it is bound.
  void guard(Socket& socket) const;

  /// Peers sent away so far. Any thread.
  [[nodiscard]] std::uint64_t refused() const noexcept { return refused_.load(std::memory_order_relaxed); }

 private:
  void answer_until_stopped();
  [[nodiscard]] bool known(std::span<const std::byte> key) const;

  CurveServer curve_;
  std::set<std::string, std::less<>> allowed_;
  Socket door_;
  Socket stop_, stopped_;  // a pair: what ends the thread
  std::atomic<std::uint64_t> refused_{0};
  std::thread thread_;
};

/// Gives a subscriber's socket its identity. Before it is connected.
void identify(Socket& socket, const CurveClient& curve);

}  // namespace armature::navproto
