#include <cstdlib>

#include "tracker/segmentation/stored_background.h"

// The picture of an empty site: whatever the bytes, it is refused in one line or as large as it says.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace armature;
  const auto background = parse_background(std::as_bytes(std::span(bytes, size)), "background");
  if (!background) {
    if (background.error().message.find('\n') != std::string::npos) std::abort();
    return 0;
  }
  if (background->depth_mm.size() !=
      static_cast<std::size_t>(background->width) * static_cast<std::size_t>(background->height))
    std::abort();
  return 0;
}
