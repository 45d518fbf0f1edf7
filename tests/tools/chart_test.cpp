#include "tools/evaluation/chart.h"

#include <gtest/gtest.h>

namespace armature::tools {
namespace {

int count(const std::string& text, const std::string& what) {
  int n = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) ++n;
  return n;
}

const ChartText kText = {.title = "Error", .x_axis = "distance, m", .y_axis = "cm"};

TEST(Chart, ALineHasADiscForEachValueAndSaysWhatItShows) {
  const std::string svg = line_chart(kText, {1, 2, 3}, {{"ours", {1, 2, 3}, 0}, {"theirs", {3, 2, 1}, 1}}, 0, 4);
  EXPECT_EQ(count(svg, "<circle"), 6);
  for (const char* text : {">Error<", ">distance, m<", ">cm<", ">ours<", ">theirs<", ">2<"}) {
    EXPECT_EQ(count(svg, text) > 0, true) << text;
  }
  EXPECT_EQ(count(svg, ">-0<"), 0);
  EXPECT_EQ(svg.substr(svg.size() - 7), "</svg>\n");
}

TEST(Chart, BarsAreAsLongAsTheirValues) {
  const std::string svg = bar_chart(kText, {"head", "knee"}, {{"ours", {10, 5}, 0}});
  EXPECT_EQ(count(svg, "height=\"7.0\""), 2);
  EXPECT_EQ(count(svg, "width=\"514.3\""), 1);  // 540 pixels are 1.05 times the largest value
  EXPECT_EQ(count(svg, "width=\"257.1\""), 1);
}

TEST(Chart, NothingToShowIsAnEmptyChart) {
  EXPECT_EQ(count(line_chart(kText, {}, {}, 0, 1), "<circle"), 0);
  EXPECT_EQ(count(bar_chart(kText, {}, {}), "height=\"7.0\""), 0);
}

}  // namespace
}  // namespace armature::tools
