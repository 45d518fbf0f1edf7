#pragma once

#include <cstdint>
#include <span>

#include "tracker/segmentation/depth_grid.h"

namespace armature {

/// The share, in [0, 1], of the cells with this label that lie on the two largest planes found among them. Cupboards
/// and boards are near 1; a body is round. Deterministic. Realtime-safe: yes.
[[nodiscard]] float flatness(const DepthGrid& grid, std::span<const std::uint8_t> labels, std::uint8_t label) noexcept;

}  // namespace armature
