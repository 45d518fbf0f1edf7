#pragma once

#include <cstdint>
#include <vector>

namespace armature::viewer {

/// A picture in memory.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;  // [height][width][3], sRGB, the top row first
};

}  // namespace armature::viewer
