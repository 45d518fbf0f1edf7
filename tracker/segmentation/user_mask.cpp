#include "tracker/segmentation/user_mask.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace armature {
namespace {

constexpr float kFloorThickness = 0.025F;  ///< metres of what stands on the floor that are given up with it

std::size_t at(int i) noexcept { return static_cast<std::size_t>(i); }

}  // namespace

float floor_margin(const ImagePlane& floor, float w) noexcept {
  // At a height h above the floor a surface is nearer than the floor behind it: dw = w h / (camera height).
  const float per_metre = std::sqrt(floor.a * floor.a + floor.b * floor.b + floor.c * floor.c);
  return std::max(1.8F * kDisparityStep, kFloorThickness * w * per_metre);
}

void draw_user_mask(DepthView frame, const MaskInput& input, std::span<std::uint8_t> mask,
                    std::span<User> users) noexcept {
  const DepthGrid& grid = input.grid;
  const int s = grid.stride;
  const int width = frame.width();
  const int height = frame.height();
  std::memset(mask.data(), 0, mask.size());
  for (int y = 0; y < grid.height; ++y) {
    const int v_end = std::min((y + 1) * s, height);
    for (int x = 0; x < grid.width; ++x) {
      // The cells around this one, whose surfaces its pixels may continue.
      std::array<std::uint8_t, 9> owner{};
      std::array<float, 9> depth_mm{};
      bool anybody = false;
      for (int dy = -1; dy <= 1; ++dy) {
        if (y + dy < 0 || y + dy >= grid.height) continue;
        for (int dx = -1; dx <= 1; ++dx) {
          if (x + dx < 0 || x + dx >= grid.width) continue;
          const int cell = (y + dy) * grid.width + x + dx;
          const auto k = at((dy + 1) * 3 + dx + 1);
          owner[k] = input.owners[at(cell)];
          depth_mm[k] = 1e3F * grid.depth[at(cell)];
          anybody |= owner[k] != 0;
        }
      }
      if (!anybody) continue;
      const int u_end = std::min((x + 1) * s, width);
      for (int v = y * s; v < v_end; ++v) {
        const int side_y = 2 * (v - y * s) < s - (s & 1) ? 0 : 6;
        for (int u = x * s; u < u_end; ++u) {
          const std::uint16_t mm = frame.at(u, v);
          if (mm == 0) continue;
          const int side_x = 2 * (u - x * s) < s - (s & 1) ? 0 : 2;
          const float z_mm = static_cast<float>(mm);
          std::uint8_t best = 0;
          float best_step = 1e3F * continuity_tolerance(1e-3F * z_mm);
          for (const int k : {4, 3 + side_x, side_y + 1, side_y + side_x}) {
            const float step = std::abs(depth_mm[at(k)] - z_mm);
            if (step >= best_step) continue;
            best_step = step;
            best = owner[at(k)];
          }
          if (best == 0) continue;
          if (input.floor != nullptr) {
            const float ray_x = static_cast<float>((u - frame.intrinsics.centre_x_px) / frame.intrinsics.focal_x_px);
            const float ray_y = static_cast<float>((v - frame.intrinsics.centre_y_px) / frame.intrinsics.focal_y_px);
            const float w = 1e3F / z_mm;
            if (w - input.floor->inverse_depth(ray_x, ray_y) < floor_margin(*input.floor, w)) continue;
          }
          mask[at(v) * at(width) + at(u)] = input.ids[best - std::size_t{1}];
          User& user = users[best - std::size_t{1}];
          if (user.pixel_count++ == 0) {
            user.left = u;
            user.top = v;
            user.right = u + 1;
            user.bottom = v + 1;
          } else {
            user.left = std::min(user.left, u);
            user.top = std::min(user.top, v);
            user.right = std::max(user.right, u + 1);
            user.bottom = std::max(user.bottom, v + 1);
          }
        }
      }
    }
  }
}

}  // namespace armature
