#pragma once

#include <cstdint>
#include <span>

#include "tracker/segmentation/depth_grid.h"
#include "tracker/segmentation/planes.h"
#include "tracker/segmentation/segmenter.h"

namespace armature {

/// What draw_user_mask() needs to know beside the frame.
struct MaskInput {
  const DepthGrid& grid;
  std::span<const std::uint8_t> owners;  ///< [grid.height][grid.width], 0 = nobody, else 1 + place
  std::span<const std::uint8_t> ids;     ///< by place
  const ImagePlane* floor = nullptr;
};

/// Brings the grid's owners to full resolution: a pixel belongs to the user of that cell around it whose depth it
/// shares; pixels between two depths (flying pixels) and floor belong to nobody. `mask` is [height][width]. Adds to
/// `users` (one a place) the pixel count and bounding box. Realtime-safe: yes.
void draw_user_mask(DepthView frame, const MaskInput& input, std::span<std::uint8_t> mask,
                    std::span<User> users) noexcept;

/// How far above the floor a surface must be so as not to be taken for it, in 1/m of inverse depth.
[[nodiscard]] float floor_margin(const ImagePlane& floor, float inverse_depth) noexcept;

}  // namespace armature
