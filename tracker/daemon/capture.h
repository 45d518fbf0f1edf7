#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <thread>

#include "firmware_host/depth_source.h"
#include "firmware_host/latest_frame.h"

namespace armature {

/// Where the daemon's frames come from, by either of two ways: read by a thread that keeps the newest (live), or read
/// by the caller, one after the other (lossless).
class Capture {
 public:
  Capture(std::unique_ptr<DepthSource> source, bool lossless);

  /// The next frame, waiting for it for at most `timeout`; nullptr where none came or none will. Valid until the next
  /// call.
  [[nodiscard]] const DepthFrame* next(std::chrono::milliseconds timeout);

  [[nodiscard]] bool finished() const noexcept;
  /// Why it finished, if not because the stream was over. Once finished() is true.
  [[nodiscard]] const std::optional<Error>& failure() const noexcept { return failure_; }

  [[nodiscard]] const SourceInfo& info() const noexcept { return source_->info(); }
  /// Only of sources that take it from any thread: those that are read by a process of their own.
  void show(StatusLight light) {
    if (lossless_ || source_->info().live) source_->show(light);
  }
  /// Of the last frame, to a source that brings itself back.
  void judge(bool good) noexcept { source_->judge(good); }
  [[nodiscard]] SourceHealth health() const { return source_->health(); }
  [[nodiscard]] std::uint64_t dropped() const noexcept { return latest_.dropped(); }

 private:
  void run(const std::stop_token& stop);

  std::unique_ptr<DepthSource> source_;
  bool lossless_;
  DepthFrame frame_;  // lossless
  bool over_ = false;
  std::optional<Error> failure_;
  LatestFrame latest_;
  std::jthread thread_;
};

}  // namespace armature
