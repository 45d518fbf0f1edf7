#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace armature::tools {

struct Rgb {
  std::uint8_t r = 0, g = 0, b = 0;
  friend bool operator==(const Rgb&, const Rgb&) = default;
};

/// `t` = 0 gives a, 1 gives b.
[[nodiscard]] Rgb mixed(Rgb a, Rgb b, double t) noexcept;

struct Style {
  Rgb colour{201, 209, 217};
  bool bold = false;
  friend bool operator==(const Style&, const Style&) = default;
};

/// One character cell.
struct Cell {
  char32_t glyph = U' ';
  Style style;
  friend bool operator==(const Cell&, const Cell&) = default;
};

/// How many colours a terminal shows.
enum class ColourDepth : std::uint8_t { None, Palette256, TrueColour };

/// A picture made of characters, [height][width]. Whatever is put outside of it is clipped.
class Screen {
 public:
  Screen(int width, int height);

  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return height_; }
  [[nodiscard]] const Cell& at(int column, int row) const noexcept;

  void put(int column, int row, char32_t glyph, Style style = {}) noexcept;
  /// Writes UTF-8 from left to right, one column a code point; control characters become spaces. At most `limit`
  /// columns; the column after the last.
  int put(int column, int row, std::string_view utf8, Style style = {}, int limit = 1 << 20);

 private:
  int width_;
  int height_;
  std::vector<Cell> cells_;
};

/// The escape sequences that turn a terminal that shows `before` into one that shows `after`; with other sizes, the
/// whole screen.
[[nodiscard]] std::string ansi_update(const Screen& before, const Screen& after, ColourDepth depth);

/// The characters alone, a line a row, without trailing blanks.
[[nodiscard]] std::string plain_text(const Screen& screen);

/// An SVG picture of the screen. Braille, blocks and lines are drawn as shapes, so that it looks the same whatever
/// fonts there are.
[[nodiscard]] std::string svg(const Screen& screen, std::string_view title);

/// How many columns a text takes: its code points.
[[nodiscard]] int columns_of(std::string_view utf8) noexcept;

/// Appends a code point as UTF-8.
void append_utf8(std::string& text, char32_t glyph);

}  // namespace armature::tools
