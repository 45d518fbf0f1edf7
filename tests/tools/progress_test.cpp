#include "tools/progress.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <string>

#include <gtest/gtest.h>

namespace armature::tools {
namespace {

using namespace std::chrono_literals;

/// A file that is no terminal, read back.
class Log {
 public:
  Log() : file_(std::tmpfile()) {}
  ~Log() { std::fclose(file_); }
  Log(const Log&) = delete;
  Log& operator=(const Log&) = delete;
  [[nodiscard]] std::FILE* file() const { return file_; }
  [[nodiscard]] std::string text() const {
    std::rewind(file_);
    std::array<char, 4096> bytes{};
    const auto count = std::fread(bytes.data(), 1, bytes.size(), file_);
    return {bytes.data(), count};
  }

 private:
  std::FILE* file_;
};

TEST(ProgressLine, NamesPercentRateAndTimeLeft) {
  const ProgressState half{.title = "training", .fraction = 0.5, .elapsed = 60s, .total = 3000, .unit = "images"};
  EXPECT_EQ(progress_line(half, 0), "training:  50 %  25.0 images/s  1:00 min left");
}

TEST(ProgressLine, DrawsABarInEighthsOfACell) {
  const ProgressState state{.title = "x", .fraction = 0.5, .elapsed = 0s, .total = 0, .unit = ""};
  EXPECT_EQ(progress_line(state, 20), "x ▕████▌    ▏  50 %");
}

TEST(ProgressLine, LeavesTheBarOutWhereThereIsNoRoom) {
  const ProgressState state{.title = "a long title", .fraction = 0.5, .elapsed = 10s, .total = 0, .unit = ""};
  EXPECT_EQ(progress_line(state, 25), "a long title  50 %  10 s");
}

TEST(ProgressLine, TakesAnyFraction) {
  ProgressState state{.title = "x", .fraction = 2, .elapsed = 3s, .total = 0, .unit = ""};
  EXPECT_EQ(progress_line(state, 0), "x: 100 %  done in 3 s");
  state.fraction = -1;
  EXPECT_EQ(progress_line(state, 0), "x:   0 %");
}

TEST(ProgressBar, WritesSparsePlainLinesWhereThereIsNoTerminal) {
  const Log log;
  const auto clock = std::make_shared<ManualClock>();
  {
    ProgressBar bar({.title = "import", .total = 100, .unit = "frames", .out = log.file(), .clock = clock});
    const auto progress = bar.callback();
    for (int i = 1; i <= 100; ++i) {
      clock->advance(100ms);
      progress(i / 100.0);
    }
  }
  const std::string text = log.text();
  EXPECT_EQ(text.substr(0, 45), "import:  10 %  10.0 frames/s  9 s left\nimport");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 10);
  EXPECT_NE(text.find("import: 100 %  10.0 frames/s  done in 10 s\n"), std::string::npos);
}

TEST(ProgressBar, SaysNothingWhenSilent) {
  const Log log;
  { ProgressBar({.title = "import", .silent = true, .out = log.file()}).update(1); }
  EXPECT_EQ(log.text(), "");
}

TEST(ProgressBar, SaysNothingWhenTheJobNeverBegan) {
  const Log log;
  { const ProgressBar bar({.title = "import", .out = log.file()}); }
  EXPECT_EQ(log.text(), "");
}

}  // namespace
}  // namespace armature::tools
