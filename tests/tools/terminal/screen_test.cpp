#include "tools/terminal/screen.h"

#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "tools/terminal/braille.h"

namespace armature::tools {
namespace {

TEST(Screen, ClipsWhatIsPutOutsideOfIt) {
  Screen screen(4, 2);
  screen.put(2, 0, "abcdef");
  screen.put(-1, 1, "xy");
  screen.put(0, 7, "z");
  EXPECT_EQ(plain_text(screen), "  ab\ny\n");
}

TEST(Screen, CountsCodePointsAndSurvivesWhatIsNoUtf8) {
  Screen screen(8, 1);
  EXPECT_EQ(screen.put(0, 0, "é°\xff\x1b!\xe2"), 6);
  EXPECT_EQ(plain_text(screen), "é°\uFFFD !\uFFFD\n");
  EXPECT_EQ(columns_of("15 °/s"), 6);
}

TEST(Screen, StopsAtTheLimit) {
  Screen screen(8, 1);
  EXPECT_EQ(screen.put(1, 0, "abcdef", {}, 3), 4);
  EXPECT_EQ(plain_text(screen), " abc\n");
}

TEST(AnsiUpdate, WritesOnlyWhatHasChanged) {
  Screen before(10, 3);
  before.put(0, 0, "steering");
  Screen after = before;
  EXPECT_EQ(ansi_update(before, after, ColourDepth::TrueColour), "");
  after.put(2, 1, U'x', {{1, 2, 3}, true});
  EXPECT_EQ(ansi_update(before, after, ColourDepth::TrueColour), "\x1b[2;3H\x1b[0;1;38;2;1;2;3mx");
  EXPECT_EQ(ansi_update(before, after, ColourDepth::Palette256), "\x1b[2;3H\x1b[0;1;38;5;16mx");
  EXPECT_EQ(ansi_update(before, after, ColourDepth::None), "\x1b[2;3H\x1b[1mx");
}

TEST(AnsiUpdate, ClearsAndDrawsEverythingAfterAChangeOfSize) {
  Screen after(3, 1);
  after.put(1, 0, U'a');
  const std::string update = ansi_update(Screen(2, 1), after, ColourDepth::None);
  EXPECT_EQ(update, "\x1b[0m\x1b[2J\x1b[1;2H\x1b[0ma");
}

TEST(Braille, PutsEachDotIntoItsBit) {
  BrailleCanvas canvas(1, 1);
  Screen screen(1, 1);
  canvas.dot({0, 0}, {}, 0);
  canvas.dot({1, 3}, {}, 0);
  canvas.draw_on(screen, 0, 0);
  EXPECT_EQ(screen.at(0, 0).glyph, char32_t{0x2800 + 0x01 + 0x80});
}

TEST(Braille, AHigherLayerTakesOverItsCells) {
  BrailleCanvas canvas(2, 1);
  Screen screen(2, 1);
  canvas.line({0, 0}, {3, 0}, {1, 1, 1}, 0);
  canvas.dot({0, 3}, {2, 2, 2}, 1);
  canvas.dot({1, 1}, {3, 3, 3}, 0);
  canvas.draw_on(screen, 0, 0);
  EXPECT_EQ(screen.at(0, 0).glyph, char32_t{0x2800 + 0x40});
  EXPECT_EQ(screen.at(0, 0).style.colour, (Rgb{2, 2, 2}));
  EXPECT_EQ(screen.at(1, 0).glyph, char32_t{0x2800 + 0x01 + 0x08});
}

TEST(Braille, IgnoresWhatIsNowhere) {
  BrailleCanvas canvas(2, 2);
  Screen screen(2, 2);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  canvas.dot({nan, 0}, {}, 0);
  canvas.line({0, -1e30}, {nan, 1e30}, {}, 0);
  canvas.disc({1e30, 0}, 2, {}, 0);
  canvas.circle({0, nan}, 2, {}, 0);
  canvas.dot({-1, 0}, {}, 0);
  canvas.draw_on(screen, 0, 0);
  EXPECT_EQ(plain_text(screen), "\n\n");
}

TEST(Svg, DrawsDotsAsDotsAndTextAsText) {
  Screen screen(4, 1);
  screen.put(0, 0, U'\u2801', {{255, 0, 0}, false});
  screen.put(1, 0, "<a", {{0, 255, 0}, false});
  const std::string picture = svg(screen, "A & B");
  EXPECT_NE(picture.find("stroke=\"#ff0000\" d=\"M18.5 18.5h0\""), std::string::npos) << picture;
  EXPECT_NE(picture.find("textLength=\"20\" fill=\"#00ff00\">&lt;a</text>"), std::string::npos) << picture;
  EXPECT_NE(picture.find("<title>A &amp; B</title>"), std::string::npos);
}

}  // namespace
}  // namespace armature::tools
