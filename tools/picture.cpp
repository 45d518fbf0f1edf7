#include "tools/picture.h"

#include <algorithm>
#include <cmath>
#include <system_error>

#include <png.h>

#include "tracker/body/body_parts.h"

namespace armature::tools {
namespace {

Colour mixed(const std::array<double, 3>& a, const std::array<double, 3>& b, double share) {
  Colour out{};
  for (std::size_t i = 0; i < 3; ++i) out[i] = static_cast<std::uint8_t>(std::lround(a[i] + share * (b[i] - a[i])));
  return out;
}

}  // namespace

void Picture::set(int u, int v, const Colour& colour) noexcept {
  if (u < 0 || v < 0 || u >= width_ || v >= height_) return;
  const std::size_t at =
      3 * (static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(u));
  std::copy(colour.begin(), colour.end(), rgb_.begin() + static_cast<std::ptrdiff_t>(at));
}

void Picture::paste(int u, int v, int width, std::span<const std::uint8_t> rgb) noexcept {
  for (std::size_t i = 0; 3 * i + 2 < rgb.size(); ++i) {
    const int pixel = static_cast<int>(i);
    set(u + pixel % width, v + pixel / width, {rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]});
  }
}

Expected<void> Picture::write_png(const std::filesystem::path& path) const {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width_);
  image.height = static_cast<png_uint_32>(height_);
  image.format = PNG_FORMAT_RGB;
  const std::filesystem::path unfinished = path.string() + ".part";
  std::error_code error;
  if (png_image_write_to_file(&image, unfinished.c_str(), 0, rgb_.data(), 0, nullptr) == 0) {
    std::filesystem::remove(unfinished, error);
    return fail(path.string() + ": cannot be written: " + image.message);
  }
  std::filesystem::rename(unfinished, path, error);
  if (error) return fail(path.string() + ": cannot be written: " + error.message());
  return {};
}

Colour depth_colour(std::uint16_t depth_mm) noexcept {
  if (depth_mm == 0) return {0, 0, 0};
  constexpr std::array<double, 3> kNear = {255, 240, 150}, kMiddle = {200, 70, 90}, kFar = {25, 25, 70};
  const double share = std::clamp((depth_mm - 800.0) / 3700.0, 0.0, 1.0);
  return share < 0.5 ? mixed(kNear, kMiddle, 2 * share) : mixed(kMiddle, kFar, 2 * share - 1);
}

Colour part_colour(std::uint8_t part) noexcept {
  if (part == kNoPart) return {60, 60, 60};
  // Neighbours in the list are far apart on the colour wheel: steps of the golden ratio.
  const double hue = std::fmod(part * 0.38196601125, 1.0) * 6;
  const double rising = 1 - std::abs(std::fmod(hue, 2.0) - 1);
  std::array<double, 3> rgb{};
  const auto sector = static_cast<std::size_t>(hue);
  constexpr std::array<std::array<int, 2>, 6> kOrder = {{{0, 1}, {1, 0}, {1, 2}, {2, 1}, {2, 0}, {0, 2}}};
  rgb[static_cast<std::size_t>(kOrder[sector][0])] = 1;
  rgb[static_cast<std::size_t>(kOrder[sector][1])] = rising;
  const double light = part % 2 == 0 ? 1.0 : 0.72;
  for (double& channel : rgb) channel = 45 + 210 * channel * light;
  return mixed(rgb, rgb, 0);
}

}  // namespace armature::tools
