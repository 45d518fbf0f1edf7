#pragma once

#include <vector>

#include <armature/navproto/codec.h>

#include "armature_generated.h"

// Between plain messages and FlatBuffers. Private: nothing installed includes this.

namespace armature::navproto {

using Builder = flatbuffers::FlatBufferBuilder;

/// A message's body; its caller finishes the buffer.
[[nodiscard]] flatbuffers::Offset<wire::Navigation> pack(Builder& builder, const NavigationMessage& message);
[[nodiscard]] flatbuffers::Offset<wire::Skeleton> pack(Builder& builder, const SkeletonMessage& message);
[[nodiscard]] flatbuffers::Offset<wire::Event> pack(Builder& builder, const EventMessage& message);
[[nodiscard]] flatbuffers::Offset<wire::Health> pack(Builder& builder, const HealthMessage& message);
[[nodiscard]] flatbuffers::Offset<wire::Feed> pack(Builder& builder, const FeedView& view,
                                                   std::span<const std::uint8_t> depth_zstd,
                                                   std::span<const std::uint8_t> user_mask_zstd);
[[nodiscard]] flatbuffers::Offset<wire::Request> pack(Builder& builder, const ControlRequest& message);
[[nodiscard]] flatbuffers::Offset<wire::Reply> pack(Builder& builder, const ControlReply& message);
[[nodiscard]] wire::Header pack(const Header& header);

/// Bodies whose structure is verified to messages; fails on what would not fit one. Values are not judged here.
[[nodiscard]] Header unpack(const wire::Header& header);
[[nodiscard]] Expected<NavigationMessage> unpack(const wire::Navigation& body);
[[nodiscard]] Expected<SkeletonMessage> unpack(const wire::Skeleton& body);
[[nodiscard]] Expected<EventMessage> unpack(const wire::Event& body);
[[nodiscard]] Expected<HealthMessage> unpack(const wire::Health& body);
[[nodiscard]] Expected<FeedMessage> unpack(const wire::Feed& body);
[[nodiscard]] Expected<ControlRequest> unpack(const wire::Request& body);
[[nodiscard]] Expected<ControlReply> unpack(const wire::Reply& body);

/// Marks an encoded part as sent again at `sent`, in place.
void mark_replayed(std::span<std::byte> part, std::chrono::nanoseconds sent) noexcept;

/// `text` as the wire allows it: one line of valid UTF-8 of at most 1024 bytes; what is not becomes '?'.
[[nodiscard]] std::string sanitised(std::string text);
[[nodiscard]] bool is_text(std::string_view text) noexcept;
inline constexpr std::size_t kMaxTextBytes = 1024;

inline constexpr std::size_t kPrefixBytes = 8;  ///< topic and schema version

}  // namespace armature::navproto
