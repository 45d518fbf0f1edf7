#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "firmware_host/depth_frame.h"

namespace armature {

/// A frame thinned to at most about 160x120 cells, on which everything but the final mask is computed. A cell stands
/// for a square of stride x stride pixels.
struct DepthGrid {
  int stride = 1;
  int width = 0;
  int height = 0;
  float cell_width_rad = 0;  ///< metres across a cell at a depth of one metre
  float cell_height_rad = 0;
  std::vector<float> ray_x;          ///< [width], x/z of a cell's centre
  std::vector<float> ray_y;          ///< [height], y/z of a cell's centre
  std::vector<float> depth;          ///< [height][width], metres along z, 0 = no return
  std::vector<float> inverse_depth;  ///< [height][width], 1/m, 0 = no return

  [[nodiscard]] int size() const noexcept { return width * height; }
  [[nodiscard]] Eigen::Vector3f point(int cell) const noexcept {
    const float z = depth[static_cast<std::size_t>(cell)];
    return {ray_x[static_cast<std::size_t>(cell % width)] * z, ray_y[static_cast<std::size_t>(cell / width)] * z, z};
  }
  /// Square metres that a cell stands for, seen face on.
  [[nodiscard]] float area(float z) const noexcept { return cell_width_rad * cell_height_rad * z * z; }
};

/// Whether images of this kind can be worked on: sides within [1, kMaxImageSide], finite, positive focal lengths.
[[nodiscard]] bool usable(const Intrinsics& intrinsics) noexcept;

/// Takes memory for the grid of usable images.
[[nodiscard]] DepthGrid make_depth_grid(const Intrinsics& intrinsics);

/// Fills the grid from an image of the size it was made for. Realtime-safe: yes.
void sample(DepthView frame, DepthGrid& grid) noexcept;

/// Calls use(x, y, cell) for the cells of [height][width] with a non-zero mark, row by row. Few are marked, as a rule:
/// what is not is passed over eight at a time.
template <typename Use>
void for_each_marked(const DepthGrid& grid, std::span<const std::uint8_t> marks, const Use& use) {
  const auto width = static_cast<std::size_t>(grid.width);
  for (int y = 0; y < grid.height; ++y) {
    const std::size_t begin = static_cast<std::size_t>(y) * width;
    for (std::size_t i = begin; i < begin + width;) {
      std::uint64_t eight = 1;
      if (i + sizeof eight <= begin + width) std::memcpy(&eight, &marks[i], sizeof eight);
      if (eight == 0) {
        i += sizeof eight;
        continue;
      }
      for (const std::size_t end = std::min(i + sizeof eight, begin + width); i < end; ++i) {
        if (marks[i] != 0) use(static_cast<int>(i - begin), y, i);
      }
    }
  }
}

/// By how much the depth of neighbouring cells of one surface may differ, metres. Structured light measures disparity:
/// its noise grows with the square of the distance.
[[nodiscard]] constexpr float continuity_tolerance(float z) noexcept {
  return 0.03F + 0.006F * z * z;
}

/// A step of a Kinect's disparity, in 1/m (Khoshelham and Elberink 2012: 1/8 pixel, f = 580 px, baseline 7.5 cm).
inline constexpr float kDisparityStep = 1.0F / 348.0F;

}  // namespace armature
