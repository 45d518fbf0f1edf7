#pragma once

#include <algorithm>
#include <cstdint>

#include "tracker/forest/forest.h"

namespace armature {

/// One person cut out of a depth image: everything else, and a frame of one pixel all around, reads as
/// kBackgroundDepth_mm.
struct PersonImage {
  const std::uint16_t* depth_mm = nullptr;  ///< [height][width], row-major
  int width = 0;
  int height = 0;
};

/// Pixels per millimetre at one depth, in 65536ths.
struct ProbeScale {
  std::int32_t x = 0, y = 0;
};

/// Focal lengths in 65536ths of a pixel.
struct FixedFocal {
  std::int32_t x = 0, y = 0;
};

/// The most that a scale may be so that kMaxProbe_mm times it stays within 32 bits.
inline constexpr std::int32_t kMaxProbeScale = 1'000'000;

[[nodiscard]] inline FixedFocal fixed_focal(double focal_x_px, double focal_y_px) noexcept {
  const auto fixed = [](double px) { return static_cast<std::int32_t>(std::clamp(px, 0.0, 32000.0) * 65536.0 + 0.5); };
  return {fixed(focal_x_px), fixed(focal_y_px)};
}

/// `depth_mm` must not be zero.
[[nodiscard]] inline ProbeScale probe_scale(FixedFocal focal, std::uint16_t depth_mm) noexcept {
  return {std::min(focal.x / depth_mm, kMaxProbeScale), std::min(focal.y / depth_mm, kMaxProbeScale)};
}

/// The depth at an offset of (x_mm, y_mm) from the pixel (u, v) of the image.
[[nodiscard]] inline int probe(const PersonImage& image, int u, int v, ProbeScale scale, std::int32_t x_mm,
                               std::int32_t y_mm) noexcept {
  // An arithmetic shift, so both signs round the same way.
  const int x = std::clamp(u + ((x_mm * scale.x + 32768) >> 16), 0, image.width - 1);
  const int y = std::clamp(v + ((y_mm * scale.y + 32768) >> 16), 0, image.height - 1);
  return image.depth_mm[y * image.width + x];
}

/// The feature of a node (Shotton et al. 2011, equation 1) in millimetres.
[[nodiscard]] inline int part_feature(const PersonImage& image, int u, int v, ProbeScale scale,
                                      const SplitNode& node) noexcept {
  return probe(image, u, v, scale, node.u_mm[0], node.u_mm[1]) - probe(image, u, v, scale, node.v_mm[0], node.v_mm[1]);
}

}  // namespace armature
