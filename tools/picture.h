#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "firmware_host/error.h"

namespace armature::tools {

using Colour = std::array<std::uint8_t, 3>;

/// Pixels to look at.
class Picture {
 public:
  Picture(int width, int height) : width_(width), height_(height) {
    rgb_.resize(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  }

  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return height_; }

  /// Ignores what lies outside.
  void set(int u, int v, const Colour& colour) noexcept;

  /// Puts another picture, `rgb` [rows][width][3], with its upper left corner at (u, v). Ignores what lies outside.
  void paste(int u, int v, int width, std::span<const std::uint8_t> rgb) noexcept;

  /// Writes a PNG under a temporary name and renames it when complete.
  [[nodiscard]] Expected<void> write_png(const std::filesystem::path& path) const;

 private:
  int width_;
  int height_;
  std::vector<std::uint8_t> rgb_;  // [height][width][3]
};

/// Near is bright yellow, far dark blue; black where there is no depth.
[[nodiscard]] Colour depth_colour(std::uint16_t depth_mm) noexcept;

/// A colour of its own for each of the body's parts, grey for kNoPart.
[[nodiscard]] Colour part_colour(std::uint8_t part) noexcept;

}  // namespace armature::tools
