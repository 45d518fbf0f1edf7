#include "firmware_host/backends/light_thread.h"

#include <utility>

namespace armature {

/// How often the clock, which may be anybody's, is asked whether the rest is over.
constexpr std::chrono::seconds kLookAgain{1};

LightThread::LightThread(std::function<bool(StatusLight)> send, std::shared_ptr<Clock> clock)
    : send_(std::move(send)), clock_(std::move(clock)), thread_([this](const std::stop_token& stop) { run(stop); }) {}

void LightThread::show(StatusLight light) {
  {
    const std::lock_guard lock(mutex_);
    wanted_ = light;
  }
  changed_.notify_one();
}

void LightThread::run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  for (;;) {
    if (wanted_) {
      changed_.wait_for(lock, stop, kLookAgain, [this] { return due(); });
    } else {
      changed_.wait(lock, stop, [this] { return due(); });
    }
    if (!due()) {
      if (stop.stop_requested()) return;
      continue;
    }
    const StatusLight light = *std::exchange(wanted_, std::nullopt);
    lock.unlock();
    const bool shown = send_(light);
    lock.lock();
    if (shown) continue;
    if (!wanted_) wanted_ = light;
    not_before_ = clock_->now() + kRest;
  }
}

}  // namespace armature
