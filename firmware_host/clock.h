#pragma once

#include <chrono>
#include <thread>

namespace armature {

/// The host's time, injected so that tests and replays decide what time it is. Times are since an arbitrary epoch and
/// never run backwards. Thread-safe: yes. Realtime-safe: now() yes, sleep_until() no.
class Clock {
 public:
  virtual ~Clock() = default;
  [[nodiscard]] virtual std::chrono::nanoseconds now() const noexcept = 0;
  virtual void sleep_until(std::chrono::nanoseconds time) = 0;
};

/// CLOCK_MONOTONIC.
class SteadyClock final : public Clock {
 public:
  [[nodiscard]] std::chrono::nanoseconds now() const noexcept override {
    return std::chrono::steady_clock::now().time_since_epoch();
  }
  void sleep_until(std::chrono::nanoseconds time) override {
    std::this_thread::sleep_until(
        std::chrono::steady_clock::time_point(std::chrono::duration_cast<std::chrono::steady_clock::duration>(time)));
  }
};

/// A clock that stands still until it is told otherwise; sleeping advances it at once. For one thread.
class ManualClock final : public Clock {
 public:
  [[nodiscard]] std::chrono::nanoseconds now() const noexcept override { return now_; }
  void sleep_until(std::chrono::nanoseconds time) override {
    if (time > now_) now_ = time;
  }
  void advance(std::chrono::nanoseconds by) { now_ += by; }

 private:
  std::chrono::nanoseconds now_{0};
};

}  // namespace armature
