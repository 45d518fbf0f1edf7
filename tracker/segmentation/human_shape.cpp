#include "tracker/segmentation/human_shape.h"

#include <algorithm>

#include "tracker/segmentation/flatness.h"

namespace armature {
namespace {

// What may become a user. Metres; a component may be only the upper body, or cut by the image's edge.
constexpr float kMinBodyArea = 0.13F;
constexpr float kMinBodyHeight = 0.45F;
constexpr float kMaxBodyHeight = 2.4F;
constexpr float kMaxBodyWidth = 2.1F;
constexpr float kMaxBodyDepth = 1.5F;
constexpr float kMinHeadHeight = 1.05F;  ///< above the floor: a chair's back is lower, a seated person higher
constexpr float kMaxHeadHeight = 2.4F;
constexpr float kMaxFeetHeight = 0.75F;  ///< above the floor, if they are seen: what hangs on a wall is higher
// Of the lower side of somebody behind a counter; arms may reach beyond it.
constexpr float kMinHidden = 0.15F;
constexpr float kHiddenShare = 0.25F;

// What was there from the first frame may be furniture: what goes on above the image is taller than this, what goes on
// beside it is wider.
constexpr float kMaxCutHeadHeight = 1.75F;
constexpr float kMinCutWidth = 0.35F;
/// The largest flatness of bodies seen at a distance, as measured on synthetic people (0.66 at 2.5 m, 0.76 at 3.0, 0.82
/// at 3.4, 0.87 at 3.8, 0.90 at 4.2), and some more. Cupboards have 0.88 to 0.98.
constexpr float max_flatness(float z) noexcept {
  return std::clamp(0.70F + 0.16F * (z - 2.5F), 0.70F, 0.93F);
}

/// Whether head and feet are where a person's may be. Heights above the floor.
bool upright(const Component& c, const std::optional<FloorPlane>& floor) noexcept {
  if (!floor) return true;
  const float head = c.highest + floor->offset;
  const float feet = c.lowest + floor->offset;
  if (head > kMaxHeadHeight || (head < kMinHeadHeight && !c.cut_above)) return false;
  const bool stands_behind_something = c.hidden_below > std::max(kMinHidden, kHiddenShare * c.width());
  return c.cut_below || stands_behind_something || feet < kMaxFeetHeight;
}

}  // namespace

bool human_sized(const Component& c, const std::optional<FloorPlane>& floor) noexcept {
  return c.area >= kMinBodyArea && c.area <= kMaxBodyArea && c.height() >= kMinBodyHeight &&
         c.height() <= kMaxBodyHeight && c.width() <= kMaxBodyWidth && c.far - c.near <= kMaxBodyDepth &&
         upright(c, floor);
}

bool pair_sized(const Component& c, const std::optional<FloorPlane>& floor) noexcept {
  return c.area >= 2 * kMinOfPairArea && c.area <= 2 * kMaxBodyArea && c.height() >= kMinBodyHeight &&
         c.height() <= kMaxBodyHeight && c.width() <= kMaxPairWidth && c.far - c.near <= kMaxBodyDepth &&
         upright(c, floor);
}

bool looks_flat(const DepthGrid& grid, const ComponentFinder& components, std::size_t c) noexcept {
  const float z = components.components()[c].centre.z();
  return flatness(grid, components.labels(), static_cast<std::uint8_t>(c + 1)) > max_flatness(z);
}

bool looks_like_furniture(const DepthGrid& grid, const ComponentFinder& components, std::size_t c,
                          const std::optional<FloorPlane>& floor) noexcept {
  const Component& thing = components.components()[c];
  if (floor && thing.cut_above && thing.highest + floor->offset > kMaxCutHeadHeight) return true;
  if (thing.cut_aside && thing.width() < kMinCutWidth) return true;
  return looks_flat(grid, components, c);
}

bool one_body_in_two(const Component& a, const Component& b, const std::optional<FloorPlane>& floor) noexcept {
  constexpr float kOverlap = 0.6F;  // of the narrower one
  constexpr float kAbove = 0.15F;
  const float common = std::min(a.right, b.right) - std::max(a.left, b.left);
  if (common < kOverlap * std::min(a.width(), b.width())) return false;
  if ((a.highest - b.highest) * (a.lowest - b.lowest) <= 0 || std::abs(a.highest - b.highest) < kAbove) return false;
  Component both = a;
  both.area += b.area;
  both.left = std::min(a.left, b.left);
  both.right = std::max(a.right, b.right);
  both.near = std::min(a.near, b.near);
  both.far = std::max(a.far, b.far);
  both.lowest = std::min(a.lowest, b.lowest);
  both.highest = std::max(a.highest, b.highest);
  both.cut_above |= b.cut_above;
  both.cut_below |= b.cut_below;
  return human_sized(both, floor);
}

float most_to_attach(const Component& piece, const Component& body) noexcept {
  const bool was_not_there = piece.foreground_cells * 2 > piece.cells;
  if (was_not_there) return 0.3F;
  constexpr float kLimb = 0.12F;
  constexpr float kRemnant = 0.012F;
  constexpr float kShinHeight = 0.32F;
  if (piece.centre.z() < body.centre.z() + 0.05F) return kLimb;
  const bool shin = 0.5F * (piece.lowest + piece.highest) - body.lowest < kShinHeight && piece.area > kRemnant;
  return shin ? kLimb : 0.0F;
}

}  // namespace armature
