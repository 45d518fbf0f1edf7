#include <algorithm>
#include <cstdlib>
#include <cstring>

#include <sys/mman.h>
#include <unistd.h>

#include "firmware_host/capture/shared_frames.h"

// What a capture process that has gone mad leaves in the shared memory: the reader's frames are what they say, or none.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace armature;
  static auto frames = SharedFrames::create();
  static const std::size_t length = [] {
    return static_cast<std::size_t>(::lseek(frames->descriptor(), 0, SEEK_END));
  }();
  static auto* memory =
      static_cast<std::uint8_t*>(::mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_SHARED, frames->descriptor(), 0));
  // Every four bytes: where (of the first 512 bytes, or of a slot's head) and what.
  constexpr std::size_t kSlotBytes = 2 * SharedFrames::kMaxPixels;
  for (std::size_t i = 0; i + 4 <= size; i += 4) {
    const std::size_t base = (bytes[i] & 3U) * kSlotBytes;
    const std::size_t at = base + ((bytes[i] >> 2U) | static_cast<std::size_t>(bytes[i + 1]) << 6U) % 1024;
    if (at + 2 < length) std::memcpy(memory + at, bytes + i + 2, 2);
  }
  DepthFrame frame;
  if (frames->read(frame) == SharedFrames::Read::Frame) {
    const auto& k = frame.intrinsics;
    if (frame.depth_mm.size() != static_cast<std::size_t>(k.width) * static_cast<std::size_t>(k.height)) std::abort();
  }
  if (frames->trouble().size() > 1024) std::abort();
  const double fps = frames->frames_per_second();
  if (!(fps > 0 && fps < 1001)) std::abort();
  return 0;
}
