#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string_view>

#include <armature/navproto/error.h>
#include <armature/navproto/feed_message.h>
#include <armature/navproto/publisher.h>

namespace armature::navproto {

/// Publishes depth and user mask, compressed, while somebody subscribes and not otherwise.
/// Thread-safe: no. Realtime-safe: no (compressing 640x480 takes milliseconds): not on the tracking thread.
class FeedPublisher {
 public:
  /// Binds `feed` of endpoints_of(endpoint); fails as Publisher::bind does.
  [[nodiscard]] static Expected<FeedPublisher> bind(std::string_view endpoint, PublisherOptions options = {});
  ~FeedPublisher();
  FeedPublisher(FeedPublisher&&) noexcept;
  FeedPublisher& operator=(FeedPublisher&&) noexcept;

  /// Peers sent away so far because their key is not on the list. Any thread.
  [[nodiscard]] std::uint64_t strangers() const noexcept;

  /// Whether anybody subscribes right now.
  [[nodiscard]] bool wanted() noexcept;

  /// Compresses and sends where somebody subscribes; whether it did. The view's header and
  /// times.published are filled in on the way. Fails where check() objects.
  Expected<bool> publish(const FeedView& view);

 private:
  struct Impl;
  explicit FeedPublisher(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

/// Receives the newest frame of the feed, on a thread of its own. Thread-safe: no.
class FeedSubscriber {
 public:
  /// Connects to `feed` of endpoints_of(endpoint), whether or not somebody publishes there yet; fails where the
  /// endpoint is malformed.
  [[nodiscard]] static Expected<FeedSubscriber> connect(std::string_view endpoint,
                                                        const std::optional<CurveClient>& curve = {});
  ~FeedSubscriber();
  FeedSubscriber(FeedSubscriber&&) noexcept;
  FeedSubscriber& operator=(FeedSubscriber&&) noexcept;

  /// The newest frame not yet handed out, waiting for at most `timeout`; nothing where none has come. Fails where it
  /// cannot be decoded; the next one may be fine.
  [[nodiscard]] Expected<std::optional<FeedMessage>> receive(std::chrono::milliseconds timeout);

 private:
  struct Impl;
  explicit FeedSubscriber(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace armature::navproto
