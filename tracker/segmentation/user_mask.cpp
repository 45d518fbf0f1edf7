#include "tracker/segmentation/user_mask.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace armature {
namespace {

std::size_t at(int i) noexcept {
  return static_cast<std::size_t>(i);
}

/// A cell and the eight around it, whose surfaces its pixels may continue; row by row, the cell itself in the middle.
struct Neighbourhood {
  std::array<std::uint8_t, 9> owner{};
  std::array<float, 9> depth_mm{};
};

Neighbourhood neighbourhood(const MaskInput& input, int x, int y) noexcept {
  const DepthGrid& grid = input.grid;
  Neighbourhood around;
  for (int dy = -1, k = 0; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx, ++k) {
      if (y + dy < 0 || y + dy >= grid.height || x + dx < 0 || x + dx >= grid.width) continue;
      const auto cell = at((y + dy) * grid.width + x + dx);
      around.owner[at(k)] = input.owners[cell];
      around.depth_mm[at(k)] = 1e3F * grid.depth[cell];
    }
  }
  return around;
}

/// Whether a cell and the eight around it belong to one user.
bool one_surface(const MaskInput& input, int x, int y) noexcept {
  const DepthGrid& grid = input.grid;
  if (x == 0 || y == 0 || x + 1 == grid.width || y + 1 == grid.height) return false;
  const std::uint8_t* const middle = &input.owners[at(y * grid.width + x)];
  bool same = *middle != 0;
  for (const std::uint8_t* const row : {middle - grid.width, middle, middle + grid.width}) {
    same &= row[-1] == *middle && row[0] == *middle && row[1] == *middle;
  }
  return same;
}

/// The pixels of one cell.
struct Block {
  int left, top, right, bottom;
};

/// The user of a pixel, 0 = nobody.
std::uint8_t owner_of(const Neighbourhood& around, float z_mm, int side_x, int side_y) noexcept {
  std::uint8_t best = 0;
  float best_step = 1e3F * continuity_tolerance(1e-3F * z_mm);
  for (const int k : {4, 3 + side_x, side_y + 1, side_y + side_x}) {
    const float step = std::abs(around.depth_mm[at(k)] - z_mm);
    if (step >= best_step) continue;
    best_step = step;
    best = around.owner[at(k)];
  }
  return best;
}

/// Whether all pixels of a block have a depth within `reach_mm` of `depth_mm`.
bool all_near(DepthView frame, const Block& block, float depth_mm, float reach_mm) noexcept {
  bool near = true;
  for (int v = block.top; v < block.bottom; ++v) {
    const std::uint16_t* const row = &frame.depth_mm[at(v) * at(frame.width())];
    for (int u = block.left; u < block.right; ++u) {
      near &= row[u] != 0 && std::abs(static_cast<float>(row[u]) - depth_mm) < reach_mm;
    }
  }
  return near;
}

/// Counts the pixels of a block as hers.
void add(const Block& block, User& user) noexcept {
  if (user.pixel_count == 0) {
    user.left = block.left;
    user.top = block.top;
  }
  user.pixel_count += (block.right - block.left) * (block.bottom - block.top);
  user.left = std::min(user.left, block.left);
  user.top = std::min(user.top, block.top);
  user.right = std::max(user.right, block.right);
  user.bottom = std::max(user.bottom, block.bottom);
}

/// Rows and columns of the grid in which there is somebody, and one more on each side; empty where there is nobody.
Block occupied(const MaskInput& input) noexcept {
  const DepthGrid& grid = input.grid;
  Block box{grid.width, grid.height, 0, 0};
  for (int y = 0; y < grid.height; ++y) {
    const auto row = input.owners.subspan(at(y * grid.width), at(grid.width));
    const auto first = std::ranges::find_if(row, [](std::uint8_t owner) { return owner != 0; });
    if (first == row.end()) continue;
    int last = grid.width - 1;
    while (row[at(last)] == 0) --last;
    box.left = std::min(box.left, static_cast<int>(first - row.begin()) - 1);
    box.right = std::max(box.right, last + 2);
    box.top = std::min(box.top, y - 1);
    box.bottom = y + 2;
  }
  return {std::max(box.left, 0), std::max(box.top, 0), std::min(box.right, grid.width),
          std::min(box.bottom, grid.height)};
}

}  // namespace

void draw_user_mask(DepthView frame, const MaskInput& input, std::span<std::uint8_t> mask,
                    std::span<User> users) noexcept {
  const DepthGrid& grid = input.grid;
  const int s = grid.stride;
  const int half = s / 2;
  const Intrinsics& k = frame.intrinsics;
  std::memset(mask.data(), 0, mask.size());
  const auto centre_x = static_cast<float>(k.centre_x_px);
  const auto centre_y = static_cast<float>(k.centre_y_px);
  const auto per_pixel_x = static_cast<float>(1 / k.focal_x_px);
  const auto per_pixel_y = static_cast<float>(1 / k.focal_y_px);
  const Block box = occupied(input);
  // Whether there is anybody in a column's three cells about row y; one column more on each side.
  std::array<std::uint8_t, kMaxImageSide + 2> column{};
  for (int y = box.top; y < box.bottom; ++y) {
    for (int x = box.left; x < box.right; ++x) {
      std::uint8_t any = 0;
      for (int row = std::max(y - 1, 0); row <= std::min(y + 1, grid.height - 1); ++row)
        any |= input.owners[at(row * grid.width + x)];
      column[at(x + 1)] = any;
    }
    for (int x = box.left; x < box.right; ++x) {
      if ((column[at(x)] | column[at(x + 1)] | column[at(x + 2)]) == 0) continue;
      const auto cell = at(y * grid.width + x);
      const bool same_user = one_surface(input, x, y);
      const Block block{x * s, y * s, std::min((x + 1) * s, k.width), std::min((y + 1) * s, k.height)};
      // Well above the floor the pixels need not be held against it one by one.
      const bool near_floor =
          input.floor != nullptr &&
          (!same_user || input.floor->covers(grid.ray_x[at(x)], grid.ray_y[at(y)], grid.inverse_depth[cell], 4));
      const float depth_mm = 1e3F * grid.depth[cell];
      const float same_surface_mm = 1e3F * continuity_tolerance(1e-3F * depth_mm);
      if (same_user && !near_floor && all_near(frame, block, depth_mm, same_surface_mm)) {
        const std::size_t place = input.owners[cell] - std::size_t{1};
        for (int v = block.top; v < block.bottom; ++v) {
          std::fill_n(&mask[at(v) * at(k.width) + at(block.left)], block.right - block.left, input.ids[place]);
        }
        add(block, users[place]);
        continue;
      }
      const Neighbourhood around = neighbourhood(input, x, y);
      for (int v = block.top; v < block.bottom; ++v) {
        const int side_y = v - block.top < half ? 0 : 6;
        const auto row = at(v) * at(k.width);
        for (int u = block.left; u < block.right; ++u) {
          const std::uint16_t mm = frame.depth_mm[row + at(u)];
          if (mm == 0) continue;
          const auto z_mm = static_cast<float>(mm);
          const bool inside = same_user && std::abs(z_mm - depth_mm) < same_surface_mm;
          const std::uint8_t owner =
              inside ? around.owner[4] : owner_of(around, z_mm, u - block.left < half ? 0 : 2, side_y);
          if (owner == 0) continue;
          if (near_floor && input.floor->covers((static_cast<float>(u) - centre_x) * per_pixel_x,
                                                (static_cast<float>(v) - centre_y) * per_pixel_y, 1e3F / z_mm))
            continue;
          mask[row + at(u)] = input.ids[owner - std::size_t{1}];
          add({u, v, u + 1, v + 1}, users[owner - std::size_t{1}]);
        }
      }
    }
  }
}

}  // namespace armature
