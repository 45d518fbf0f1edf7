#include "tracker/segmentation/depth_grid.h"

#include <algorithm>
#include <cmath>

namespace armature {
namespace {

constexpr int kMaxCells = 25'000;

/// Apart from the rest of sample() and free of branches, so that it runs in vector registers.
void invert(DepthGrid& grid) noexcept {
  for (std::size_t cell = 0; cell < grid.depth.size(); ++cell) {
    const float z = grid.depth[cell];
    const float inverse = 1.0F / (z > 0 ? z : 1.0F);
    grid.inverse_depth[cell] = z > 0 ? inverse : 0.0F;
  }
}

}  // namespace

bool usable(const Intrinsics& k) noexcept {
  const auto positive = [](double f) { return std::isfinite(f) && f > 1e-3; };
  return k.width >= 1 && k.height >= 1 && k.width <= kMaxImageSide && k.height <= kMaxImageSide &&
         positive(k.focal_x_px) && positive(k.focal_y_px) && std::isfinite(k.centre_x_px) &&
         std::isfinite(k.centre_y_px);
}

DepthGrid make_depth_grid(const Intrinsics& k) {
  DepthGrid grid;
  const auto cells = [](int pixels, int stride) { return (pixels + stride - 1) / stride; };
  while (cells(k.width, grid.stride) * cells(k.height, grid.stride) > kMaxCells) ++grid.stride;
  grid.width = cells(k.width, grid.stride);
  grid.height = cells(k.height, grid.stride);
  grid.cell_width_rad = static_cast<float>(grid.stride / k.focal_x_px);
  grid.cell_height_rad = static_cast<float>(grid.stride / k.focal_y_px);
  const double middle = grid.stride / 2;
  for (int x = 0; x < grid.width; ++x)
    grid.ray_x.push_back(static_cast<float>((x * grid.stride + middle - k.centre_x_px) / k.focal_x_px));
  for (int y = 0; y < grid.height; ++y)
    grid.ray_y.push_back(static_cast<float>((y * grid.stride + middle - k.centre_y_px) / k.focal_y_px));
  grid.depth.assign(static_cast<std::size_t>(grid.size()), 0.0F);
  grid.inverse_depth.assign(static_cast<std::size_t>(grid.size()), 0.0F);
  return grid;
}

void sample(DepthView frame, DepthGrid& grid) noexcept {
  const int s = grid.stride;
  if (s == 1) {
    for (std::size_t cell = 0; cell < grid.depth.size(); ++cell)
      grid.depth[cell] = 1e-3F * static_cast<float>(frame.depth_mm[cell]);
    return invert(grid);
  }
  const int last_u = frame.width() - 1;
  const int last_v = frame.height() - 1;
  std::size_t cell = 0;
  for (int y = 0; y < grid.height; ++y) {
    const int v = std::min(y * s + s / 2, last_v);
    for (int x = 0; x < grid.width; ++x, ++cell) {
      const int u = std::min(x * s + s / 2, last_u);
      std::uint16_t mm = frame.at(u, v);
      // A drop-out of one pixel is not a hole.
      if (mm == 0) {
        mm = frame.at(std::max(u - 1, 0), v);
        if (mm == 0) mm = frame.at(u, std::max(v - 1, 0));
        if (mm == 0) mm = frame.at(std::max(u - 1, 0), std::max(v - 1, 0));
      }
      grid.depth[cell] = 1e-3F * static_cast<float>(mm);
    }
  }
  invert(grid);
}

}  // namespace armature
