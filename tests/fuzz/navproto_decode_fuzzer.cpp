// Whatever the bytes, a decoder answers with a message that may travel, which encodes and decodes to itself, or with
// one line.

#include <cstdint>
#include <cstdlib>

#include <armature/navproto/codec.h>

namespace armature::navproto {
namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

std::span<const std::byte> encode(Encoder& encoder, const FeedMessage& message) {
  return encoder.encode(message.view());
}
template <class Message>
std::span<const std::byte> encode(Encoder& encoder, const Message& message) {
  return encoder.encode(message);
}

template <class Message>
void decode_any(std::span<const std::byte> bytes) {
  static Encoder encoder;
  const auto message = decode<Message>(bytes);
  if (!message) {
    require(!message.error().message.empty());
    require(message.error().message.find('\n') == std::string::npos);
    return;
  }
  const auto part = encode(encoder, *message);
  require(!part.empty());
  const auto again = decode<Message>(part);
  require(again.has_value() && *again == *message);
}

}  // namespace
}  // namespace armature::navproto

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace armature::navproto;
  const auto bytes = std::as_bytes(std::span(data, size));
  decode_any<NavigationMessage>(bytes);
  decode_any<SkeletonMessage>(bytes);
  decode_any<EventMessage>(bytes);
  decode_any<HealthMessage>(bytes);
  decode_any<FeedMessage>(bytes);
  decode_any<ControlRequest>(bytes);
  decode_any<ControlReply>(bytes);
  return 0;
}
