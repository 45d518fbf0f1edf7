#include "tools/evaluation/chart.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/printf.h>

namespace armature::tools {
namespace {

const char* colour_of(const Series& series) {
  return kChartColours[series.colour % kChartColours.size()];
}

constexpr int kWidth = 720;

/// The distance between ticks, 1, 2 or 5 times a power of ten, that gives about five of them.
double tick_step(double span) {
  const double raw = span / 5, power = std::pow(10, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (raw <= factor * power) return factor * power;
  }
  return 10 * power;
}

/// Builds the picture; coordinates in pixels from its upper left corner.
class Canvas {
 public:
  Canvas(const ChartText& text, int height) : height_(height) {
    out_ = fmt::sprintf("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" role=\"img\">\n", kWidth,
                        height) +
           "<title>" + text.title + "</title>\n" +
           fmt::sprintf("<rect width=\"%d\" height=\"%d\" fill=\"#ffffff\"/>\n", kWidth, height) +
           "<g font-family=\"sans-serif\" font-size=\"13\" fill=\"#222222\">\n";
    label(16, 24, text.title, "start", "font-size=\"16\" font-weight=\"bold\"");
  }

  void label(double x, double y, const std::string& text, const char* anchor, const char* more = "") {
    out_ += fmt::sprintf("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\" %s>", x, y, anchor, more) + text + "</text>\n";
  }
  void line(double x0, double y0, double x1, double y1, const char* colour, double width) {
    out_ +=
        fmt::sprintf("<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" stroke=\"%s\" stroke-width=\"%.1f\"/>\n",
                     x0, y0, x1, y1, colour, width);
  }
  void box(double x, double y, double width, double height, const char* colour) {
    out_ += fmt::sprintf("<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"%s\"/>\n", x, y,
                         std::max(0.0, width), height, colour);
  }
  void disc(double x, double y, const char* colour) {
    out_ += fmt::sprintf("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3.5\" fill=\"%s\"/>\n", x, y, colour);
  }
  void legend(const std::vector<Series>& series) {
    double x = 16;
    for (const Series& one : series) {
      box(x, 36, 12, 12, colour_of(one));
      label(x + 18, 47, one.name, "start");
      x += 40 + 7.2 * static_cast<double>(one.name.size());
    }
  }
  [[nodiscard]] std::string finish() const { return out_ + "</g>\n</svg>\n"; }
  [[nodiscard]] int height() const { return height_; }

 private:
  int height_;
  std::string out_;
};

/// From a value to a place.
struct Axis {
  double low, high, from, to;
  [[nodiscard]] double operator()(double value) const { return from + (value - low) / (high - low) * (to - from); }
  [[nodiscard]] std::vector<double> ticks() const {
    const double step = tick_step(high - low);
    std::vector<double> out;
    for (double i = std::ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) out.push_back(i * step + 0.0);
    return out;
  }
};

}  // namespace

std::string line_chart(const ChartText& text, const std::vector<double>& x, const std::vector<Series>& series,
                       double y_low, double y_high) {
  Canvas canvas(text, 420);
  const auto [least, most] = std::minmax_element(x.begin(), x.end());
  const Axis across{x.empty() ? 0 : *least, x.size() < 2 ? 1 : *most, 70, kWidth - 30.0};
  const Axis up{y_low, y_high, canvas.height() - 50.0, 66};
  for (const double tick : up.ticks()) {
    canvas.line(across.from, up(tick), across.to, up(tick), "#dddddd", 1);
    canvas.label(across.from - 8, up(tick) + 4, fmt::sprintf("%g", std::round(tick * 1e6) / 1e6), "end");
  }
  for (const double tick : across.ticks()) {
    canvas.line(across(tick), up.from, across(tick), up.from + 5, "#222222", 1);
    canvas.label(across(tick), up.from + 20, fmt::sprintf("%g", std::round(tick * 1e6) / 1e6), "middle");
  }
  canvas.line(across.from, up.from, across.to, up.from, "#222222", 1);
  canvas.label(0.5 * (across.from + across.to), canvas.height() - 10.0, text.x_axis, "middle");
  canvas.label(18, 0.5 * (up.from + up.to), text.y_axis, "middle",
               fmt::sprintf("transform=\"rotate(-90 18 %.1f)\"", 0.5 * (up.from + up.to)).c_str());
  for (const Series& one : series) {
    const char* colour = colour_of(one);
    const auto at = [&](std::size_t i) { return up(std::clamp(one.values[i], y_low, y_high)); };
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (i > 0) canvas.line(across(x[i - 1]), at(i - 1), across(x[i]), at(i), colour, 2);
      canvas.disc(across(x[i]), at(i), colour);
    }
  }
  canvas.legend(series);
  return canvas.finish();
}

std::string bar_chart(const ChartText& text, const std::vector<std::string>& labels,
                      const std::vector<Series>& series) {
  constexpr double kBar = 8, kGap = 7, kTop = 62;
  const double group = kBar * static_cast<double>(series.size()) + kGap;
  Canvas canvas(text, static_cast<int>(kTop + group * static_cast<double>(labels.size()) + 52));
  double most = 0;
  for (const Series& one : series) {
    for (const double value : one.values) most = std::max(most, value);
  }
  const Axis across{0, most > 0 ? 1.05 * most : 1, 150, kWidth - 30.0};
  const double bottom = kTop + group * static_cast<double>(labels.size());
  for (const double tick : across.ticks()) {
    canvas.line(across(tick), kTop, across(tick), bottom, "#dddddd", 1);
    canvas.label(across(tick), bottom + 18, fmt::sprintf("%g", std::round(tick * 1e6) / 1e6), "middle");
  }
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const double y = kTop + group * static_cast<double>(i) + 0.5 * kGap;
    canvas.label(across.from - 8, y + 0.5 * (group - kGap) + 4, labels[i], "end");
    for (std::size_t s = 0; s < series.size(); ++s) {
      canvas.box(across.from, y + kBar * static_cast<double>(s), across(series[s].values[i]) - across.from, kBar - 1,
                 colour_of(series[s]));
    }
  }
  canvas.line(across.from, kTop, across.from, bottom, "#222222", 1);
  canvas.label(0.5 * (across.from + across.to), canvas.height() - 10.0, text.x_axis, "middle");
  canvas.legend(series);
  return canvas.finish();
}

}  // namespace armature::tools
