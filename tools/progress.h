#pragma once

#include <chrono>
#include <cstdio>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "firmware_host/clock.h"

namespace armature::tools {

/// How far a job has come.
struct ProgressState {
  std::string title = {};
  double fraction = 0;  ///< in [0, 1]
  std::chrono::duration<double> elapsed{0};
  double total = 0;       ///< units in the whole job; 0 leaves the rate out
  std::string unit = {};  ///< plural, as in "frames"
};

/// One line without its newline: title, bar, percent, rate and the time that is left, at most `columns` wide. Below
/// the room for a bar the bar is left out; `columns` = 0 asks for the plain form of a log.
[[nodiscard]] std::string progress_line(const ProgressState& state, int columns);

struct ProgressOptions {
  std::string title = {};
  double total = 0;       ///< units in the whole job, for the rate; 0 = no rate
  std::string unit = {};  ///< plural, as in "frames"
  bool silent = false;
  std::FILE* out = stderr;
  std::shared_ptr<Clock> clock = std::make_shared<SteadyClock>();
};

/// Shows how far a long job has come. In a terminal: a bar that redraws in place. Elsewhere: a plain line now and
/// then (each tenth of the job and each half minute, one a second at most) and one at the end.
///     ProgressBar bar({.title = "training", .total = 3000, .unit = "images"});
///     train(options, bar.callback());
/// Thread-safe: yes. Realtime-safe: no.
class ProgressBar {
 public:
  explicit ProgressBar(ProgressOptions options);
  /// Leaves the last state on a line of its own.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// `fraction` of the job is done; clamped to [0, 1]. Cheap to call often.
  void update(double fraction);
  /// The same as a callback, valid as long as the bar is.
  [[nodiscard]] std::function<void(double)> callback();
  /// Draws the last state and ends the line. Later updates do nothing.
  void finish();

 private:
  void draw(std::chrono::nanoseconds now);

  ProgressOptions options_;
  bool terminal_;
  std::mutex mutex_;
  std::chrono::nanoseconds start_;
  std::chrono::nanoseconds drawn_at_{};
  double fraction_ = 0;
  double drawn_fraction_ = -1;
  bool drawn_ = false;
  bool finished_ = false;
};

}  // namespace armature::tools
