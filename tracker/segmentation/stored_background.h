#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_host/depth_frame.h"
#include "firmware_host/error.h"

namespace armature {

/// The empty site, seen once when it was commissioned (`armature doctor --site URI --background FILE`), so that whoever
/// stands there when the daemon starts is told from the furniture at once. A picture like any other: 16-bit PGM.
struct StoredBackground {
  int width = 0;
  int height = 0;
  std::vector<std::uint16_t> depth_mm;  ///< [height][width], row-major, 0 = not known

  [[nodiscard]] bool fits(const Intrinsics& k) const noexcept { return width == k.width && height == k.height; }
};

/// The median of each pixel's returns; 0 where fewer than half of the frames have one. All of one size, at least one.
[[nodiscard]] StoredBackground median_of(std::span<const DepthFrame> frames);

/// Fails with one line where the bytes are anything but a PGM of 16 bits ("P5 WIDTH HEIGHT 65535", big-endian) with
/// sides up to kMaxImageSide. `name` stands for the file in messages.
[[nodiscard]] Expected<StoredBackground> parse_background(std::span<const std::byte> bytes, std::string_view name);
[[nodiscard]] Expected<StoredBackground> read_background(const std::filesystem::path& file);
/// The bytes that parse_background() reads back to the same.
[[nodiscard]] std::string print_background(const StoredBackground& background);

}  // namespace armature
