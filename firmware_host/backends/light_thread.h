#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "firmware_host/clock.h"
#include "firmware_host/depth_source.h"

namespace armature {

/// Shows a sensor's light from a thread of its own, for a device that may take its time or not answer at all: whoever
/// reads frames never waits for a lamp. The newest wins. After a failure nothing is tried for a minute, then the
/// newest. Thread-safe: yes.
class LightThread {
 public:
  static constexpr std::chrono::seconds kRest{60};

  /// `send` is called by the thread and by nobody else; false: it failed.
  LightThread(std::function<bool(StatusLight)> send, std::shared_ptr<Clock> clock);
  /// What was asked for last is shown before, unless it is no time to try: this waits for `send`.
  ~LightThread() = default;

  /// Returns at once.
  void show(StatusLight light);

 private:
  void run(const std::stop_token& stop);
  [[nodiscard]] bool due() const { return wanted_ && clock_->now() >= not_before_; }

  std::function<bool(StatusLight)> send_;
  std::shared_ptr<Clock> clock_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::optional<StatusLight> wanted_;  // and not shown yet
  std::chrono::nanoseconds not_before_ = std::chrono::nanoseconds::min();
  std::jthread thread_;
};

}  // namespace armature
