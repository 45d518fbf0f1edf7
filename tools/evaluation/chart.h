#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace armature::tools {

/// Blue, orange, grey and green, told apart by everybody (Okabe and Ito 2008).
inline constexpr std::array<const char*, 4> kChartColours = {"#0072b2", "#d55e00", "#777777", "#009e73"};

/// A line of a chart, or a set of its bars.
struct Series {
  std::string name;
  std::vector<double> values;  ///< one a position
  std::size_t colour = 0;      ///< of kChartColours; the same thing has the same one in every chart
};

/// What both charts say beside their data.
struct ChartText {
  std::string title;
  std::string x_axis;
  std::string y_axis;
};

/// Lines over positions on a number axis, as an SVG picture. `x` and each series' values have the same length; y goes
/// from `y_low` to `y_high`.
[[nodiscard]] std::string line_chart(const ChartText& text, const std::vector<double>& x,
                                     const std::vector<Series>& series, double y_low, double y_high);

/// Bars side by side, lying, a group a label from top to bottom, as an SVG picture. The value axis begins at zero.
[[nodiscard]] std::string bar_chart(const ChartText& text, const std::vector<std::string>& labels,
                                    const std::vector<Series>& series);

}  // namespace armature::tools
