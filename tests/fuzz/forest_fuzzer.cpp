#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "tracker/forest/checksum.h"
#include "tracker/forest/part_classifier.h"

namespace {

using namespace armature;

/// A model that the reader accepts must also be safe to walk.
void classify(Forest forest) {
  const Intrinsics intrinsics{16, 12, 15, 15, 8, 6};
  std::vector<std::uint16_t> depth(16 * 12);
  for (std::size_t i = 0; i < depth.size(); ++i) depth[i] = static_cast<std::uint16_t>(500 + 37 * i);
  const std::vector<std::uint8_t> mask(depth.size(), 1);
  PartClassifier classifier(std::make_shared<const Forest>(std::move(forest)), {.stride = 1});
  classifier.reset(intrinsics);
  DepthView view;
  view.depth_mm = depth;
  view.intrinsics = intrinsics;
  (void)classifier.classify(view, mask, 1);
}

}  // namespace

/// The first byte chooses: the rest as a whole file, or as a payload behind a header that fits it, so that what lies
/// behind the checksum is reached too.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto input = std::as_bytes(std::span(data, size)).subspan(1);
  std::vector<std::byte> file;
  if (data[0] % 2 == 0) {
    file.assign(input.begin(), input.end());
  } else {
    const auto put = [&](std::uint64_t value, int bytes) {
      for (int i = 0; i < bytes; ++i) file.push_back(static_cast<std::byte>(value >> (8 * i) & 0xFFU));
    };
    for (const char c : {'A', 'R', 'M', 'F', 'O', 'R', 'S', 'T'}) file.push_back(static_cast<std::byte>(c));
    put(2, 4);
    put(crc32(input), 4);
    put(input.size(), 8);
    file.insert(file.end(), input.begin(), input.end());
  }
  auto forest = Forest::parse(file, "fuzz");
  if (forest) classify(std::move(*forest));
  return 0;
}
