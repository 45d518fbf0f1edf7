#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>

#include <armature/navproto/error.h>
#include <armature/navproto/keys.h>
#include <armature/navproto/messages.h>

namespace armature::navproto {

/// A monotonic clock, injected so that tests decide what time it is. Must be thread-safe where a subscriber uses it.
using Now = std::function<std::chrono::nanoseconds()>;

/// CLOCK_MONOTONIC.
[[nodiscard]] std::chrono::nanoseconds monotonic_now() noexcept;

/// How a publisher is set up.
struct PublisherOptions {
  Now now = monotonic_now;             ///< what stamps messages
  std::uint64_t session_id = 0;        ///< 0 = drawn at random
  std::optional<CurveServer> curve{};  ///< whom a tcp endpoint lets in; without it, everybody. Of no use to ipc.
};

/// What became of messages since the publisher was bound.
struct PublisherCounters {
  std::uint64_t sent = 0;       ///< handed to the sockets
  std::uint64_t refused = 0;    ///< messages that check() objected to: a mistake of the caller, nothing went out
  std::uint64_t replayed = 0;   ///< last states sent again to somebody who had just subscribed
  std::uint64_t strangers = 0;  ///< peers sent away because their key is not on the list
};

/// Publishes navigation, skeletons, events and health. Never waits for a subscriber: one that does not keep up misses
/// messages, the others and the caller notice nothing. A publication also answers those who have just subscribed to its
/// topic with the last state; for the others serve() is called now and then (every 100 ms, say).
/// Thread-safe: no. Realtime-safe: the publish functions take no lock of ours and, after warm-up, allocate only what
/// ZeroMQ does for its message.
class Publisher {
 public:
  /// Binds the sockets `navigation`, `skeleton` and `events` of endpoints_of(endpoint). Fails in one line where the
  /// endpoint is malformed, its directory missing, or a live publisher has it; what a killed one left is taken over.
  /// Each socket has room for 96 subscribers, half of it for those of one user, or over tcp of one address.
  [[nodiscard]] static Expected<Publisher> bind(std::string_view endpoint, PublisherOptions options = {});

  ~Publisher();  ///< hands out what is queued, for at most 250 ms
  Publisher(Publisher&&) noexcept;
  Publisher& operator=(Publisher&&) noexcept;

  ///@{
  /// Fill in header and times.published and send. False where check() objects to the message; nothing is sent then.
  bool publish_navigation(NavigationMessage& message) noexcept;
  bool publish_skeleton(SkeletonMessage& message) noexcept;
  bool publish_event(EventMessage& message) noexcept;
  bool publish_health(HealthMessage& message) noexcept;
  ///@}

  /// Answers those who have just subscribed.
  void serve() noexcept;

  /// What its messages carry as Header::session_id.
  [[nodiscard]] std::uint64_t session_id() const noexcept;
  /// Up to now.
  [[nodiscard]] PublisherCounters counters() const noexcept;

 private:
  struct Impl;
  explicit Publisher(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace armature::navproto
