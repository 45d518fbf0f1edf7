#include "tools/terminal/braille.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace armature::tools {
namespace {

constexpr char32_t kEmptyBraille = 0x2800;
/// Bit of the code point for the dot at [y][x] of a cell.
constexpr std::array<std::array<std::uint8_t, 2>, 4> kBits = {{{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}}};
/// Nothing sensible is drawn farther outside than this; keeps loops short whatever the coordinates are.
constexpr double kFarOutside = 4000;

}  // namespace

BrailleCanvas::BrailleCanvas(int columns, int rows)
    : columns_(std::max(columns, 0)),
      rows_(std::max(rows, 0)),
      cells_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {}

void BrailleCanvas::dot(Dot at, Rgb colour, int layer) {
  if (!(std::abs(at.x) < kFarOutside) || !(std::abs(at.y) < kFarOutside)) return;
  const auto x = static_cast<int>(std::lround(at.x));
  const auto y = static_cast<int>(std::lround(at.y));
  if (x < 0 || y < 0 || x >= width() || y >= height()) return;
  const auto i = static_cast<std::size_t>(y / 4) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x / 2);
  Dots& cell = cells_[i];
  if (layer < cell.layer) return;
  if (layer > cell.layer) cell.bits = 0;
  cell.layer = layer;
  cell.colour = colour;
  cell.bits |= kBits[static_cast<std::size_t>(y % 4)][static_cast<std::size_t>(x % 2)];
}

void BrailleCanvas::line(Dot from, Dot to, Rgb colour, int layer, double thickness, int gap) {
  const double dx = to.x - from.x;
  const double dy = to.y - from.y;
  const double length = std::max(std::abs(dx), std::abs(dy));
  if (!(length < kFarOutside)) return;
  const int steps = std::max(1, static_cast<int>(std::ceil(length)));
  for (int i = 0; i <= steps; i += std::max(gap, 1)) {
    const double t = static_cast<double>(i) / steps;
    const Dot at{from.x + t * dx, from.y + t * dy};
    if (thickness <= 1) {
      dot(at, colour, layer);
    } else {
      disc(at, thickness / 2, colour, layer);
    }
  }
}

void BrailleCanvas::disc(Dot centre, double radius, Rgb colour, int layer) {
  if (!(std::abs(centre.x) < kFarOutside) || !(std::abs(centre.y) < kFarOutside) || !(radius < kFarOutside)) return;
  for (double y = std::ceil(centre.y - radius); y <= centre.y + radius; ++y) {
    for (double x = std::ceil(centre.x - radius); x <= centre.x + radius; ++x) {
      if ((x - centre.x) * (x - centre.x) + (y - centre.y) * (y - centre.y) <= radius * radius) {
        dot({x, y}, colour, layer);
      }
    }
  }
}

void BrailleCanvas::circle(Dot centre, double radius, Rgb colour, int layer) {
  if (!(radius < kFarOutside)) return;
  const int steps = std::max(8, static_cast<int>(radius * 8));
  for (int i = 0; i < steps; ++i) {
    const double angle = 2 * std::numbers::pi * i / steps;
    dot({centre.x + radius * std::cos(angle), centre.y + radius * std::sin(angle)}, colour, layer);
  }
}

void BrailleCanvas::draw_on(Screen& screen, int column, int row) const {
  for (int y = 0; y < rows_; ++y) {
    for (int x = 0; x < columns_; ++x) {
      const Dots& cell =
          cells_[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x)];
      if (cell.bits != 0) screen.put(column + x, row + y, kEmptyBraille + cell.bits, {cell.colour, false});
    }
  }
}

}  // namespace armature::tools
