#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include <armature/navproto/control_messages.h>
#include <armature/navproto/error.h>
#include <armature/navproto/feed_message.h>
#include <armature/navproto/messages.h>

namespace armature::navproto {

/// What a message is about: the first seven bytes of its part, and what a ZeroMQ subscriber subscribes to.
enum class Topic : std::uint8_t { Navigation, Skeleton, Event, Health, Feed, Request, Reply };
/// By Topic.
inline constexpr std::array<std::string_view, 7> kTopicPrefixes = {"arm.nav", "arm.skl", "arm.evt", "arm.hlt",
                                                                   "arm.fed", "arm.req", "arm.rep"};

/// Larger parts are refused unread, but for the feed's.
inline constexpr std::size_t kMaxMessageBytes = 65'536;
/// The same for the feed's: room for the largest image, incompressible.
inline constexpr std::size_t kMaxFeedBytes = 67'108'864;
/// Of an image of the feed, in pixels.
inline constexpr int kMaxFeedSide = 4096;

/// The topic of a part, nothing where the prefix is not ours. Says nothing about the rest of it.
[[nodiscard]] std::optional<Topic> topic_of(std::span<const std::byte> part) noexcept;

///@{
/// Why a message may not travel (a value that is not finite or out of its range, an unknown enumerator, a length);
/// nothing where it may. encode() and decode() both hold to it.
[[nodiscard]] std::optional<Error> check(const NavigationMessage& message);
[[nodiscard]] std::optional<Error> check(const SkeletonMessage& message);
[[nodiscard]] std::optional<Error> check(const EventMessage& message);
[[nodiscard]] std::optional<Error> check(const HealthMessage& message);
[[nodiscard]] std::optional<Error> check(const FeedView& view);
[[nodiscard]] std::optional<Error> check(const ControlRequest& message);
[[nodiscard]] std::optional<Error> check(const ControlReply& message);
///@}

/// Turns messages into parts. Keeps its buffers: after the first message of a kind, encoding allocates nothing.
/// The span is valid until the next call; it is empty where check() objects. Thread-safe: no. Realtime-safe: yes, after
/// warm-up and while check() does not object.
class Encoder {
 public:
  /// Allocates its buffers.
  Encoder();
  ~Encoder();
  Encoder(Encoder&&) noexcept;
  Encoder& operator=(Encoder&&) noexcept;

  ///@{
  /// The part that says it; empty where check() objects.
  [[nodiscard]] std::span<const std::byte> encode(const NavigationMessage& message);
  [[nodiscard]] std::span<const std::byte> encode(const SkeletonMessage& message);
  [[nodiscard]] std::span<const std::byte> encode(const EventMessage& message);
  [[nodiscard]] std::span<const std::byte> encode(const HealthMessage& message);
  [[nodiscard]] std::span<const std::byte> encode(const FeedView& view);
  [[nodiscard]] std::span<const std::byte> encode(const ControlRequest& message);
  [[nodiscard]] std::span<const std::byte> encode(const ControlReply& message);
  ///@}

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Turns a part into a message: prefix, version, structure (FlatBuffers' verifier) and check(). Whatever the bytes, the
/// answer is a message that may travel or one line that says what is wrong; never more memory than a valid message of
/// that size needs.
template <class Message>
[[nodiscard]] Expected<Message> decode(std::span<const std::byte> part) = delete;

///@{
/// The messages there are.
template <>
[[nodiscard]] Expected<NavigationMessage> decode(std::span<const std::byte> part);
template <>
[[nodiscard]] Expected<SkeletonMessage> decode(std::span<const std::byte> part);
template <>
[[nodiscard]] Expected<EventMessage> decode(std::span<const std::byte> part);
template <>
[[nodiscard]] Expected<HealthMessage> decode(std::span<const std::byte> part);
template <>
[[nodiscard]] Expected<FeedMessage> decode(std::span<const std::byte> part);
template <>
[[nodiscard]] Expected<ControlRequest> decode(std::span<const std::byte> part);
template <>
[[nodiscard]] Expected<ControlReply> decode(std::span<const std::byte> part);
///@}

}  // namespace armature::navproto
