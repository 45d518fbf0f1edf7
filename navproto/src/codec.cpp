#include <cstring>
#include <vector>

#include <armature/navproto/codec.h>
#include <zstd.h>

#include "navproto/src/wire.h"

namespace armature::navproto {
namespace {

static_assert(kSchemaVersion == static_cast<std::uint8_t>(wire::SchemaVersion::Current));
static_assert(kMotionCount == static_cast<std::size_t>(wire::Motion::MAX) + 1);
static_assert(kJointCount == static_cast<std::size_t>(wire::Joint::MAX) + 1);
static_assert(kJointStateNames.size() == static_cast<std::size_t>(wire::JointState::MAX) + 1);
static_assert(kSensorClockNames.size() == static_cast<std::size_t>(wire::SensorClock::MAX) + 1);
static_assert(kEngagementNames.size() == static_cast<std::size_t>(wire::Engagement::MAX) + 1);
static_assert(kStopReasonNames.size() == static_cast<std::size_t>(wire::StopReason::MAX) + 1);
static_assert(kStageCount == static_cast<std::size_t>(wire::Stage::MAX) + 1);
static_assert(kEventKindNames.size() == static_cast<std::size_t>(wire::EventKind::MAX) + 1);
static_assert(kRequestKindNames.size() == static_cast<std::size_t>(wire::RequestKind::MAX) + 1);

/// Which topic, body and size limit belong to a message.
template <class Message>
struct Kind;

template <class WireBody, Topic kItsTopic, std::size_t kItsMaxBytes = kMaxMessageBytes>
struct KindOf {
  using Wire = WireBody;
  static constexpr Topic kTopic = kItsTopic;
  static constexpr std::size_t kMaxBytes = kItsMaxBytes;
};
template <>
struct Kind<NavigationMessage> : KindOf<wire::Navigation, Topic::Navigation> {};
template <>
struct Kind<SkeletonMessage> : KindOf<wire::Skeleton, Topic::Skeleton> {};
template <>
struct Kind<EventMessage> : KindOf<wire::Event, Topic::Event> {};
template <>
struct Kind<HealthMessage> : KindOf<wire::Health, Topic::Health> {};
template <>
struct Kind<FeedMessage> : KindOf<wire::Feed, Topic::Feed, kMaxFeedBytes> {};
template <>
struct Kind<ControlRequest> : KindOf<wire::Request, Topic::Request> {};
template <>
struct Kind<ControlReply> : KindOf<wire::Reply, Topic::Reply> {};

std::string_view prefix(Topic topic) noexcept {
  return kTopicPrefixes[static_cast<std::size_t>(topic)];
}

std::optional<Error> check_body(const FeedMessage& message) {
  return check(message.view());
}
template <class Message>
std::optional<Error> check_body(const Message& message) {
  return check(message);
}

tl::unexpected<Error> refuse(Topic topic, const std::string& why) {
  return fail("message " + std::string(prefix(topic)) + ": " + why);
}

template <class Message>
Expected<Message> decode_part(std::span<const std::byte> part) {
  constexpr Topic kTopic = Kind<Message>::kTopic;
  if (part.size() < kPrefixBytes || topic_of(part) != kTopic) return refuse(kTopic, "the part does not begin so");
  const auto version = std::to_integer<unsigned>(part[kPrefixBytes - 1]);
  if (version != kSchemaVersion) {
    return refuse(kTopic, "schema version " + std::to_string(version) + " where this program speaks version " +
                              std::to_string(kSchemaVersion) + "; update the older side");
  }
  if (part.size() > Kind<Message>::kMaxBytes) return refuse(kTopic, "larger than any valid one");

  std::span<const std::byte> buffer = part.subspan(kPrefixBytes);
  std::vector<std::uint64_t> aligned;
  if (reinterpret_cast<std::uintptr_t>(buffer.data()) % alignof(std::uint64_t) != 0) {
    aligned.resize((buffer.size() + 7) / 8);
    if (!buffer.empty()) std::memcpy(aligned.data(), buffer.data(), buffer.size());
    buffer = std::as_bytes(std::span(aligned)).first(buffer.size());
  }
  flatbuffers::Verifier verifier(reinterpret_cast<const std::uint8_t*>(buffer.data()), buffer.size());
  if (!wire::VerifyMessageBuffer(verifier)) return refuse(kTopic, "truncated or not a FlatBuffer of this schema");
  const wire::Message& root = *wire::GetMessage(buffer.data());
  const auto* body = root.body_as<typename Kind<Message>::Wire>();
  if (body == nullptr) return refuse(kTopic, "the body is of another kind than the topic");

  Expected<Message> message = unpack(*body);
  if (!message) return refuse(kTopic, message.error().message);
  if constexpr (requires { message->header; }) message->header = unpack(*root.header());
  if (const auto complaint = check_body(*message)) return refuse(kTopic, complaint->message);
  return message;
}

}  // namespace

std::optional<Topic> topic_of(std::span<const std::byte> part) noexcept {
  for (std::size_t i = 0; i < kTopicPrefixes.size(); ++i) {
    const std::string_view candidate = kTopicPrefixes[i];
    if (part.size() >= candidate.size() && std::memcmp(part.data(), candidate.data(), candidate.size()) == 0) {
      return static_cast<Topic>(i);
    }
  }
  return std::nullopt;
}

struct Encoder::Impl {
  Builder builder{4096};
  std::vector<std::byte> part;
  std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> zstd{ZSTD_createCCtx(), &ZSTD_freeCCtx};
  std::vector<std::uint8_t> depth_zstd;
  std::vector<std::uint8_t> user_mask_zstd;

  template <class WireBody>
  std::span<const std::byte> finish(Topic topic, const Header& header, flatbuffers::Offset<WireBody> body) {
    const wire::Header wire_header = pack(header);
    wire::FinishMessageBuffer(
        builder, wire::CreateMessage(builder, &wire_header, wire::BodyTraits<WireBody>::enum_value, body.Union()));
    const std::string_view topic_prefix = prefix(topic);
    part.resize(kPrefixBytes + builder.GetSize());
    std::memcpy(part.data(), topic_prefix.data(), topic_prefix.size());
    part[kPrefixBytes - 1] = std::byte{kSchemaVersion};
    std::memcpy(part.data() + kPrefixBytes, builder.GetBufferPointer(), builder.GetSize());
    return part;
  }

  template <class Message>
  std::span<const std::byte> encode(const Message& message, const Header& header) {
    if (check(message)) return {};
    builder.Clear();
    return finish(Kind<Message>::kTopic, header, pack(builder, message));
  }

  /// Level 1: a depth image gains little from more, and the feed must keep up with the sensor.
  template <class Pixel>
  bool compress(std::span<const Pixel> plane, std::vector<std::uint8_t>& out) {
    out.resize(ZSTD_compressBound(plane.size_bytes()));
    const std::size_t size = ZSTD_compressCCtx(zstd.get(), out.data(), out.size(), plane.data(), plane.size_bytes(), 1);
    if (ZSTD_isError(size) != 0U) return false;
    out.resize(size);
    return true;
  }
};

Encoder::Encoder() : impl_(std::make_unique<Impl>()) {}
Encoder::~Encoder() = default;
Encoder::Encoder(Encoder&&) noexcept = default;
Encoder& Encoder::operator=(Encoder&&) noexcept = default;

std::span<const std::byte> Encoder::encode(const NavigationMessage& message) {
  return impl_->encode(message, message.header);
}
std::span<const std::byte> Encoder::encode(const SkeletonMessage& message) {
  return impl_->encode(message, message.header);
}
std::span<const std::byte> Encoder::encode(const EventMessage& message) {
  return impl_->encode(message, message.header);
}
std::span<const std::byte> Encoder::encode(const HealthMessage& message) {
  return impl_->encode(message, message.header);
}
std::span<const std::byte> Encoder::encode(const ControlRequest& message) {
  return impl_->encode(message, {});
}
std::span<const std::byte> Encoder::encode(const ControlReply& message) {
  return impl_->encode(message, {});
}

std::span<const std::byte> Encoder::encode(const FeedView& view) {
  if (check(view)) return {};
  if (!impl_->compress(view.depth_mm, impl_->depth_zstd)) return {};
  if (!impl_->compress(view.user_mask, impl_->user_mask_zstd)) return {};
  impl_->builder.Clear();
  return impl_->finish(Topic::Feed, view.header, pack(impl_->builder, view, impl_->depth_zstd, impl_->user_mask_zstd));
}

template <>
Expected<NavigationMessage> decode(std::span<const std::byte> part) {
  return decode_part<NavigationMessage>(part);
}
template <>
Expected<SkeletonMessage> decode(std::span<const std::byte> part) {
  return decode_part<SkeletonMessage>(part);
}
template <>
Expected<EventMessage> decode(std::span<const std::byte> part) {
  return decode_part<EventMessage>(part);
}
template <>
Expected<HealthMessage> decode(std::span<const std::byte> part) {
  return decode_part<HealthMessage>(part);
}
template <>
Expected<FeedMessage> decode(std::span<const std::byte> part) {
  return decode_part<FeedMessage>(part);
}
template <>
Expected<ControlRequest> decode(std::span<const std::byte> part) {
  return decode_part<ControlRequest>(part);
}
template <>
Expected<ControlReply> decode(std::span<const std::byte> part) {
  return decode_part<ControlReply>(part);
}

void mark_replayed(std::span<std::byte> part, std::chrono::nanoseconds sent) noexcept {
  wire::Header& header = *wire::GetMutableMessage(part.data() + kPrefixBytes)->mutable_header();
  header.mutate_sent_ns(sent.count());
  header.mutate_replayed(true);
}

}  // namespace armature::navproto
