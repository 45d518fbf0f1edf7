#pragma once

#include <cstddef>
#include <optional>

#include "tracker/segmentation/components.h"
#include "tracker/segmentation/depth_grid.h"
#include "tracker/segmentation/segmenter.h"

namespace armature {

// What tells people from things by their shape. All realtime-safe.

inline constexpr float kMaxBodyArea = 1.6F;     ///< square metres seen of one person at most
inline constexpr float kMinOfPairArea = 0.35F;  ///< of each of two who touch
inline constexpr float kMaxPairWidth = 2.4F;

/// Whether it may be somebody, or her upper body, or what the image's edge leaves of her.
[[nodiscard]] bool human_sized(const Component& c, const std::optional<FloorPlane>& floor) noexcept;

/// Whether it may be two people who touch.
[[nodiscard]] bool pair_sized(const Component& c, const std::optional<FloorPlane>& floor) noexcept;

/// Whether component number `c` is flatter than a body seen at its distance.
[[nodiscard]] bool looks_flat(const DepthGrid& grid, const ComponentFinder& components, std::size_t c) noexcept;

/// Of component number `c`, of human size, that has been there from the first frame.
[[nodiscard]] bool looks_like_furniture(const DepthGrid& grid, const ComponentFinder& components, std::size_t c,
                                        const std::optional<FloorPlane>& floor) noexcept;

/// Whether two components that touch may be the upper and the lower half of one person, whom a forearm or what she
/// carries cuts in two.
[[nodiscard]] bool one_body_in_two(const Component& a, const Component& b,
                                   const std::optional<FloorPlane>& floor) noexcept;

/// The largest piece beside a body that is taken for a part of it, square metres. Where the background is not known, a
/// hand or forearm may hang in the air before the body; behind it only a lower leg is likely, all else is furniture.
[[nodiscard]] float most_to_attach(const Component& piece, const Component& body) noexcept;

}  // namespace armature
