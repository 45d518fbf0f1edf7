// One image: the first byte chooses the codec, the next two the number of pixels.
#include <cstdint>
#include <vector>

#include "firmware_host/recording/depth_codec.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace armature;
  if (size < 3) return 0;
  std::vector<std::uint16_t> depth(static_cast<std::size_t>(data[1] | data[2] << 8));
  const std::vector<std::byte> payload(reinterpret_cast<const std::byte*>(data + 3),
                                       reinterpret_cast<const std::byte*>(data + size));
  static_cast<void>(decode_depth(static_cast<DepthCodec>(data[0] % 3), payload, depth));
  return 0;
}
