#pragma once

#include <cstdint>
#include <vector>

#include "tools/terminal/screen.h"

namespace armature::tools {

/// A point of a braille canvas in dots, x to the right, y down; dots lie at integers.
struct Dot {
  double x = 0;
  double y = 0;
};

/// A drawing of dots, two columns and four rows to a character cell; on a usual terminal dots are square. A cell has
/// one colour: what is drawn on a higher layer takes over its cells, what is drawn on the same layer adds its dots and
/// sets the colour.
class BrailleCanvas {
 public:
  /// Size in character cells.
  BrailleCanvas(int columns, int rows);

  [[nodiscard]] int width() const noexcept { return 2 * columns_; }  ///< dots
  [[nodiscard]] int height() const noexcept { return 4 * rows_; }    ///< dots

  void dot(Dot at, Rgb colour, int layer);
  /// `thickness` in dots; drawn in every `gap`-th dot only where gap > 1.
  void line(Dot from, Dot to, Rgb colour, int layer, double thickness = 1, int gap = 1);
  void disc(Dot centre, double radius, Rgb colour, int layer);
  void circle(Dot centre, double radius, Rgb colour, int layer);

  /// Copies all cells that have dots.
  void draw_on(Screen& screen, int column, int row) const;

 private:
  struct Dots {
    std::uint8_t bits = 0;
    int layer = -1;
    Rgb colour;
  };
  int columns_;
  int rows_;
  std::vector<Dots> cells_;  // [rows][columns]
};

}  // namespace armature::tools
