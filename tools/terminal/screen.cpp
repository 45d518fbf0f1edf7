#include "tools/terminal/screen.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace armature::tools {
namespace {

/// The code point at the front of `text`, which is shortened by it; U+FFFD for what is no UTF-8.
char32_t take_code_point(std::string_view& text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  const std::size_t length = lead < 0x80 ? 1 : lead >> 5 == 0x6 ? 2 : lead >> 4 == 0xE ? 3 : lead >> 3 == 0x1E ? 4 : 0;
  if (length == 0 || length > text.size()) {
    text.remove_prefix(1);
    return U'\uFFFD';
  }
  char32_t point = length == 1 ? lead : lead & (0xFFU >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if (byte(i) >> 6 != 2) {
      text.remove_prefix(1);
      return U'\uFFFD';
    }
    point = point << 6 | (byte(i) & 0x3FU);
  }
  text.remove_prefix(length);
  return point;
}

/// The nearest of the 6x6x6 cube and the grey ramp of a 256-colour terminal.
int palette_index(Rgb c) {
  const auto level = [](int v) { return v < 48 ? 0 : v < 115 ? 1 : (v - 35) / 40; };
  const auto value = [](int l) { return l == 0 ? 0 : 55 + 40 * l; };
  const auto distance = [&](int r, int g, int b) {
    return (r - c.r) * (r - c.r) + (g - c.g) * (g - c.g) + (b - c.b) * (b - c.b);
  };
  const int r = level(c.r), g = level(c.g), b = level(c.b);
  const int grey = std::clamp(((c.r + c.g + c.b) / 3 - 3) / 10, 0, 23);
  const int shade = 8 + 10 * grey;
  if (distance(shade, shade, shade) < distance(value(r), value(g), value(b))) return 232 + grey;
  return 16 + 36 * r + 6 * g + b;
}

void append_style(std::string& out, const Style& style, ColourDepth depth) {
  std::array<char, 40> code{};
  const char* weight = style.bold ? "1" : "0";
  switch (depth) {
    case ColourDepth::None: std::snprintf(code.data(), code.size(), "\x1b[%sm", weight); break;
    case ColourDepth::Palette256:
      std::snprintf(code.data(), code.size(), "\x1b[0;%s;38;5;%dm", weight, palette_index(style.colour));
      break;
    case ColourDepth::TrueColour:
      std::snprintf(code.data(), code.size(), "\x1b[0;%s;38;2;%d;%d;%dm", weight, style.colour.r, style.colour.g,
                    style.colour.b);
      break;
  }
  out += code.data();
}

}  // namespace

Rgb mixed(Rgb a, Rgb b, double t) noexcept {
  const double s = std::clamp(t, 0.0, 1.0);
  const auto channel = [s](int from, int to) { return static_cast<std::uint8_t>(std::lround(from + s * (to - from))); };
  return {channel(a.r, b.r), channel(a.g, b.g), channel(a.b, b.b)};
}

int columns_of(std::string_view utf8) noexcept {
  return static_cast<int>(
      std::count_if(utf8.begin(), utf8.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

void append_utf8(std::string& text, char32_t glyph) {
  const auto put = [&](char32_t byte) { text += static_cast<char>(static_cast<unsigned char>(byte)); };
  if (glyph < 0x80) {
    put(glyph);
  } else if (glyph < 0x800) {
    put(0xC0 | glyph >> 6);
    put(0x80 | (glyph & 0x3F));
  } else if (glyph < 0x10000) {
    put(0xE0 | glyph >> 12);
    put(0x80 | (glyph >> 6 & 0x3F));
    put(0x80 | (glyph & 0x3F));
  } else {
    put(0xF0 | glyph >> 18);
    put(0x80 | (glyph >> 12 & 0x3F));
    put(0x80 | (glyph >> 6 & 0x3F));
    put(0x80 | (glyph & 0x3F));
  }
}

Screen::Screen(int width, int height)
    : width_(std::max(width, 1)),
      height_(std::max(height, 1)),
      cells_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) {}

const Cell& Screen::at(int column, int row) const noexcept {
  return cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(column)];
}

void Screen::put(int column, int row, char32_t glyph, Style style) noexcept {
  if (column < 0 || row < 0 || column >= width_ || row >= height_) return;
  cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(column)] = {glyph,
                                                                                                                 style};
}

int Screen::put(int column, int row, std::string_view utf8, Style style, int limit) {
  for (int written = 0; !utf8.empty() && written < limit; ++written) {
    const char32_t point = take_code_point(utf8);
    put(column++, row, point < 0x20 || (point >= 0x7F && point < 0xA0) ? U' ' : point, style);
  }
  return column;
}

std::string ansi_update(const Screen& before, const Screen& after, ColourDepth depth) {
  const bool whole = before.width() != after.width() || before.height() != after.height();
  std::string out;
  if (whole) out += "\x1b[0m\x1b[2J";
  const Style* pen = nullptr;
  for (int row = 0; row < after.height(); ++row) {
    int cursor = -1;
    for (int column = 0; column < after.width(); ++column) {
      const Cell& cell = after.at(column, row);
      if (whole ? cell.glyph == U' ' : cell == before.at(column, row)) continue;
      if (cursor != column) {
        std::array<char, 32> move{};
        std::snprintf(move.data(), move.size(), "\x1b[%d;%dH", row + 1, column + 1);
        out += move.data();
      }
      if (cell.glyph != U' ' && (pen == nullptr || *pen != cell.style)) {
        append_style(out, cell.style, depth);
        pen = &cell.style;
      }
      append_utf8(out, cell.glyph);
      cursor = column + 1;
    }
  }
  return out;
}

std::string plain_text(const Screen& screen) {
  std::string text;
  for (int row = 0; row < screen.height(); ++row) {
    int end = screen.width();
    while (end > 0 && screen.at(end - 1, row).glyph == U' ') --end;
    for (int column = 0; column < end; ++column) append_utf8(text, screen.at(column, row).glyph);
    text += '\n';
  }
  return text;
}

}  // namespace armature::tools
