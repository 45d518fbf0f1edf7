#include <array>
#include <map>
#include <string>
#include <tuple>

#include <fmt/printf.h>

#include "tools/terminal/screen.h"

namespace armature::tools {
namespace {

constexpr int kCellWidth = 10;
constexpr int kCellHeight = 20;
constexpr int kMargin = 16;
constexpr int kBaseline = 15;
constexpr int kFontSize = 15;

std::string hex(Rgb c) {
  return fmt::sprintf("#%02x%02x%02x", c.r, c.g, c.b);
}

/// Offset of a braille dot (bit of the code point) within its cell.
constexpr std::array<std::array<int, 2>, 8> kDots = {{{0, 0}, {0, 1}, {0, 2}, {1, 0}, {1, 1}, {1, 2}, {0, 3}, {1, 3}}};

/// A line-drawing character as SVG path data about the cell's centre, empty for other characters.
std::string line_shape(char32_t glyph) {
  switch (glyph) {
    case U'─': return "m-5 0h10";
    case U'│': return "m0 -10v20";
    case U'┊': return "m0 -8v4m0 4v4m0 4v2";
    case U'╭': return "m5 0h-1q-4 0 -4 4v6";
    case U'╮': return "m-5 0h1q4 0 4 4v6";
    case U'╰': return "m5 0h-1q-4 0 -4 -4v-6";
    case U'╯': return "m-5 0h1q4 0 4 -4v-6";
    case U'├': return "m0 -10v20m0 -10h5";
    case U'┤': return "m0 -10v20m0 -10h-5";
    default: return {};
  }
}

/// A bar's character as the left and right edge of a bar in its cell; none of both for other characters.
std::array<int, 2> block_edges(char32_t glyph) {
  switch (glyph) {
    case U'━': return {0, kCellWidth};
    case U'╸': return {0, kCellWidth / 2};
    case U'╺': return {kCellWidth / 2, kCellWidth};
    default: return {0, 0};
  }
}

std::string escaped(char32_t glyph) {
  switch (glyph) {
    case U'&': return "&amp;";
    case U'<': return "&lt;";
    case U'>': return "&gt;";
    default: {
      std::string text;
      append_utf8(text, glyph);
      return text;
    }
  }
}

/// Path data by colour, so that thousands of dots become a few elements.
using Paths = std::map<std::tuple<std::uint8_t, std::uint8_t, std::uint8_t>, std::string>;

std::string& of_colour(Paths& paths, Rgb c) {
  return paths[{c.r, c.g, c.b}];
}

void append_paths(std::string& out, const Paths& paths, const char* attributes) {
  for (const auto& [colour, data] : paths) {
    const auto [r, g, b] = colour;
    out += "<path " + std::string(attributes) + " stroke=\"" + hex({r, g, b}) + "\" d=\"" + data + "\"/>\n";
  }
}

}  // namespace

std::string svg(const Screen& screen, std::string_view title) {
  const int width = screen.width() * kCellWidth + 2 * kMargin;
  const int height = screen.height() * kCellHeight + 2 * kMargin;
  std::string text;
  Paths dots, lines, bars;

  for (int row = 0; row < screen.height(); ++row) {
    const int y = kMargin + row * kCellHeight;
    for (int column = 0; column < screen.width(); ++column) {
      const Cell& cell = screen.at(column, row);
      const int x = kMargin + column * kCellWidth;
      const auto edges = block_edges(cell.glyph);
      if (cell.glyph == U' ') continue;
      if (cell.glyph >= 0x2800 && cell.glyph <= 0x28FF) {
        for (std::size_t bit = 0; bit < kDots.size(); ++bit) {
          if ((cell.glyph >> bit & 1U) == 0) continue;
          of_colour(dots, cell.style.colour) +=
              fmt::sprintf("M%.1f %.1fh0", x + 2.5 + 5 * kDots[bit][0], y + 2.5 + 5 * kDots[bit][1]);
        }
      } else if (const std::string shape = line_shape(cell.glyph); !shape.empty()) {
        of_colour(lines, cell.style.colour) += fmt::sprintf("M%d %d", x + kCellWidth / 2, y + kCellHeight / 2) + shape;
      } else if (edges[1] > 0) {
        of_colour(bars, cell.style.colour) +=
            fmt::sprintf("M%d %dH%d", x + edges[0], y + kCellHeight / 2, x + edges[1]);
      } else {
        // Consecutive characters of one style share an element; textLength keeps them on the grid.
        std::string run;
        int end = column;
        while (end < screen.width()) {
          const Cell& next = screen.at(end, row);
          const bool drawn = (next.glyph >= 0x2500 && next.glyph <= 0x25A0) || (next.glyph & ~0xFFU) == 0x2800;
          if (drawn || next.style != cell.style || (next.glyph == U' ' && screen.at(end - 1, row).glyph == U' ')) break;
          run += escaped(next.glyph);
          ++end;
        }
        text += fmt::sprintf("<text x=\"%d\" y=\"%d\" textLength=\"%d\" fill=\"%s\"%s>", x, y + kBaseline,
                             (end - column) * kCellWidth, hex(cell.style.colour).c_str(),
                             cell.style.bold ? " font-weight=\"bold\"" : "") +
                run + "</text>\n";
        column = end - 1;
      }
    }
  }

  std::string name;
  for (const char c : title) name += escaped(static_cast<unsigned char>(c));
  std::string out =
      fmt::sprintf("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" role=\"img\">\n", width, height);
  out += "<title>" + name + "</title>\n";
  out += fmt::sprintf("<rect width=\"%d\" height=\"%d\" rx=\"10\" fill=\"#0d1117\"/>\n", width, height);
  append_paths(out, dots, "stroke-width=\"3.6\" stroke-linecap=\"round\"");
  append_paths(out, lines, "fill=\"none\" stroke-width=\"1.2\"");
  append_paths(out, bars, "stroke-width=\"6\"");
  out += fmt::sprintf(
      "<g font-family=\"ui-monospace,'DejaVu Sans Mono',Menlo,Consolas,monospace\" font-size=\"%d\" "
      "xml:space=\"preserve\" lengthAdjust=\"spacingAndGlyphs\">\n",
      kFontSize);
  out += text + "</g>\n</svg>\n";
  return out;
}

}  // namespace armature::tools
