#include "tools/progress.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <sys/ioctl.h>
#include <unistd.h>

namespace armature::tools {
namespace {

using namespace std::chrono_literals;

template <class... Args>
std::string formatted(const char* format, Args... args) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, args...);
  return text.data();
}

std::string duration_text(double seconds) {
  const auto s = static_cast<long>(std::lround(std::min(seconds, 359999.0)));
  if (s < 60) return formatted("%ld s", s);
  if (s < 3600) return formatted("%ld:%02ld min", s / 60, s % 60);
  return formatted("%ld:%02ld h", s / 3600, s / 60 % 60);
}

std::string rate_text(double per_second) {
  if (per_second >= 100) return formatted("%.0f", per_second);
  if (per_second >= 10) return formatted("%.1f", per_second);
  return formatted("%.2f", per_second);
}

/// `columns` cells, filled from the left in eighths of a cell.
std::string bar_text(double fraction, int columns) {
  static constexpr std::array<const char*, 8> kEighths = {" ", "▏", "▎", "▍", "▌", "▋", "▊", "▉"};
  const int eighths = static_cast<int>(fraction * columns * 8);
  std::string bar;
  for (int c = 0; c < columns; ++c) {
    const int filled = eighths - 8 * c;
    bar += filled >= 8 ? "█" : kEighths[static_cast<std::size_t>(std::max(filled, 0))];
  }
  return bar;
}

int terminal_columns(std::FILE* out) {
  winsize size{};
  if (ioctl(fileno(out), TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return 80;
  return size.ws_col;
}

}  // namespace

std::string progress_line(const ProgressState& state, int columns) {
  constexpr int kWidestBar = 40;
  constexpr int kNarrowestBar = 8;
  const double fraction = std::isfinite(state.fraction) ? std::clamp(state.fraction, 0.0, 1.0) : 0.0;
  const double seconds = state.elapsed.count();

  std::string numbers = formatted("%3.0f %%", std::floor(fraction * 100));
  if (state.total > 0 && seconds > 0 && fraction > 0) {
    numbers += "  " + rate_text(fraction * state.total / seconds) + " " + state.unit + "/s";
  }
  if (fraction >= 1) {
    numbers += "  done in " + duration_text(seconds);
  } else if (fraction > 0 && seconds > 0) {
    numbers += "  " + duration_text(seconds * (1 - fraction) / fraction) + " left";
  }
  if (columns <= 0) return state.title + (state.title.empty() ? "" : ": ") + numbers;

  const int title_width = static_cast<int>(state.title.size()) + (state.title.empty() ? 0 : 1);
  const int room = columns - 1 - title_width - static_cast<int>(numbers.size()) - 3;
  std::string line = state.title + (state.title.empty() ? "" : " ");
  if (room >= kNarrowestBar) line += "▕" + bar_text(fraction, std::min(room, kWidestBar)) + "▏ ";
  line += numbers;
  // Only reached without a bar, where a byte is a column as long as the title is ASCII.
  if (room<kNarrowestBar&& static_cast<int>(line.size())> columns - 1) {
    line.resize(static_cast<std::size_t>(std::max(columns - 1, 0)));
  }
  return line;
}

ProgressBar::ProgressBar(ProgressOptions options)
    : options_(std::move(options)), terminal_(isatty(fileno(options_.out)) == 1), start_(options_.clock->now()) {}

ProgressBar::~ProgressBar() {
  finish();
}

void ProgressBar::update(double fraction) {
  const std::scoped_lock lock(mutex_);
  if (finished_ || options_.silent || !std::isfinite(fraction)) return;
  fraction_ = std::clamp(fraction, 0.0, 1.0);
  const auto now = options_.clock->now();
  const auto since_drawn = drawn_ ? now - drawn_at_ : now - start_;
  const bool due = terminal_ ? !drawn_ || since_drawn >= 66ms
                             : since_drawn >= 30s || (since_drawn >= 1s && fraction_ - drawn_fraction_ >= 0.1);
  if (due) draw(now);
}

std::function<void(double)> ProgressBar::callback() {
  return [this](double fraction) { update(fraction); };
}

void ProgressBar::finish() {
  const std::scoped_lock lock(mutex_);
  if (finished_ || options_.silent) return;
  finished_ = true;
  // A bar that was never drawn belongs to a job that failed before it began.
  if (!drawn_ && fraction_ == 0) return;
  if (terminal_ || fraction_ != drawn_fraction_) draw(options_.clock->now());
  if (terminal_) std::fputs("\n", options_.out);
  std::fflush(options_.out);
}

void ProgressBar::draw(std::chrono::nanoseconds now) {
  const ProgressState state{options_.title, fraction_, now - start_, options_.total, options_.unit};
  if (terminal_) {
    std::fprintf(options_.out, "\r%s\x1b[K", progress_line(state, terminal_columns(options_.out)).c_str());
  } else {
    std::fprintf(options_.out, "%s\n", progress_line(state, 0).c_str());
  }
  std::fflush(options_.out);
  drawn_ = true;
  drawn_at_ = now;
  drawn_fraction_ = fraction_;
}

}  // namespace armature::tools
