// The records of a recording, then its images: nothing may be read or written outside.
#include <cstdint>
#include <cstring>

#include "firmware_host/recording/depth_codec.h"
#include "firmware_host/recording/oni_layout.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace armature;
  const auto read_at = [&](std::uint64_t offset, std::span<std::byte> out) {
    if (offset > size || size - offset < out.size()) return false;
    if (!out.empty()) std::memcpy(out.data(), data + offset, out.size());
    return true;
  };
  const auto layout = read_oni_layout(read_at, size, "fuzzed.oni");
  if (!layout) {
    if (layout.error().message.find('\n') != std::string::npos) __builtin_trap();
    return 0;
  }
  std::vector<std::uint16_t> depth(static_cast<std::size_t>(layout->width) * static_cast<std::size_t>(layout->height));
  for (const OniFrameRecord& frame : layout->frames) {
    std::vector<std::byte> payload(frame.payload_bytes);
    if (!read_at(frame.payload_offset, payload)) __builtin_trap();
    static_cast<void>(decode_depth(layout->codec, payload, depth));
  }
  return 0;
}
