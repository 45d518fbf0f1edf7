#pragma once

#include <optional>

#include "firmware_host/depth_source.h"

namespace armature {

/// Holds a recording back to the pace it was made at: the first frame is due at once, every other one as long after it
/// as its time stamp says. Lossless: everything is due at once.
class Pacer {
 public:
  explicit Pacer(const OpenOptions& options) : pacing_(options.pacing), clock_(options.clock) {}

  /// Waits for at most `timeout` until a frame of `time` is due; whether it is.
  bool wait_until_due(std::chrono::nanoseconds time, std::chrono::nanoseconds timeout) {
    if (pacing_ == Pacing::Lossless) return true;
    const auto now = clock_->now();
    if (!start_) start_ = now - time;
    const auto due = *start_ + time;
    clock_->sleep_until(due < now + timeout ? due : now + timeout);
    return due <= clock_->now();
  }

 private:
  Pacing pacing_;
  std::shared_ptr<Clock> clock_;
  std::optional<std::chrono::nanoseconds> start_;  // the clock's time at which the recording's zero lies
};

}  // namespace armature
