#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "tracker/segmentation/depth_grid.h"
#include "tracker/segmentation/planes.h"
#include "tracker/segmentation/segmenter.h"

namespace armature {

/// What is so near the floor that it is taken for a part of it.
class FloorShadow {
 public:
  explicit FloorShadow(const ImagePlane& floor) noexcept
      : floor_(floor), per_metre_(kThickness * std::sqrt(floor.a * floor.a + floor.b * floor.b + floor.c * floor.c)) {}

  /// Whether it covers a point, grown to `times` its thickness.
  [[nodiscard]] bool covers(float ray_x, float ray_y, float inverse_depth, float times = 1) const noexcept {
    // At a height h a surface is nearer than the floor behind it: dw = w h / (camera height).
    return inverse_depth - floor_.inverse_depth(ray_x, ray_y) <
           times * std::max(1.8F * kDisparityStep, per_metre_ * inverse_depth);
  }

 private:
  static constexpr float kThickness = 0.025F;  ///< metres of what stands on the floor that are given up with it

  ImagePlane floor_;
  float per_metre_;  ///< kThickness over the camera's height
};

/// What draw_user_mask() needs to know beside the frame.
struct MaskInput {
  const DepthGrid& grid;
  std::span<const std::uint8_t> owners;  ///< [grid.height][grid.width], 0 = nobody, else 1 + place
  std::span<const std::uint8_t> ids;     ///< by place
  const FloorShadow* floor = nullptr;
};

/// Brings the grid's owners to full resolution: a pixel belongs to the user of that cell around it whose depth it
/// shares; pixels between two depths (flying pixels) and floor belong to nobody. `mask` is [height][width]. Adds to
/// `users` (one a place) the pixel count and bounding box. Realtime-safe: yes.
void draw_user_mask(DepthView frame, const MaskInput& input, std::span<std::uint8_t> mask,
                    std::span<User> users) noexcept;

}  // namespace armature
