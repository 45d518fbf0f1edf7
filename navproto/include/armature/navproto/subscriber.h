#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <armature/navproto/error.h>
#include <armature/navproto/keys.h>
#include <armature/navproto/messages.h>
#include <armature/navproto/publisher.h>

namespace armature::navproto {

/// What a subscriber listens to, and how old a velocity may be.
struct SubscriberOptions {
  std::chrono::milliseconds max_age{250};  ///< velocity() is zero when the newest navigation is older
  bool skeleton = true;                    ///< subscribe to skeletons
  bool events = true;                      ///< subscribe to events and health
  Now now = monotonic_now;                 ///< what ages are measured by
  std::optional<CurveClient> curve{};      ///< who we are, to a publisher over tcp that asks
};

/// What has come since somebody last asked.
struct Arrivals {
  bool navigation = false;  ///< a newer one
  bool skeleton = false;    ///< a newer one
  bool events = false;      ///< to be taken by take_events()
  bool health = false;      ///< a newer one
  bool error = false;       ///< another failure

  /// Whether anything has come.
  explicit operator bool() const noexcept { return navigation || skeleton || events || health || error; }
};

/// The client of a Publisher in one line:
///
///     armature::navproto::NavSubscriber nav("ipc:///run/armature/nav");
///     for (;;) camera.advance(nav.velocity(), frame_time);
///
/// The publisher may start later, stop and come back. A thread of its own receives, keeps the newest navigation,
/// skeleton and health, and queues events (the last 1024). Thread-safe: yes. velocity() takes a short lock.
class NavSubscriber {
 public:
  /// A malformed endpoint leaves a subscriber that never receives; error() says so.
  explicit NavSubscriber(std::string_view endpoint, SubscriberOptions options = {});
  ~NavSubscriber();
  NavSubscriber(const NavSubscriber&) = delete;
  NavSubscriber& operator=(const NavSubscriber&) = delete;

  /// Zero before the first message and when nothing has come for max_age, counted from when the publisher made it: a
  /// replayed state, or one that lay in a queue while this process or the network stood still, does not move a camera.
  [[nodiscard]] Velocity velocity() const noexcept;

  ///@{
  /// The newest of each, however old; nothing before the first.
  [[nodiscard]] std::optional<NavigationMessage> navigation() const;
  [[nodiscard]] std::optional<SkeletonMessage> skeleton() const;
  [[nodiscard]] std::optional<HealthMessage> health() const;
  ///@}

  /// Events that have come since the last call, in order, each once.
  [[nodiscard]] std::vector<EventMessage> take_events();

  /// Waits until something has come since the last wait() returned it, for at most `timeout`. For one waiting thread.
  [[nodiscard]] Arrivals wait(std::chrono::milliseconds timeout);

  /// The last failure: a malformed endpoint, a message that could not be decoded, a publisher of another version.
  [[nodiscard]] std::optional<Error> error() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace armature::navproto
