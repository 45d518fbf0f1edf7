#include "firmware_host/latest_frame.h"

#include <algorithm>
#include <cerrno>

#include <time.h>

namespace armature {

LatestFrame::LatestFrame() {
  sem_init(&fresh_, 0, 0);
}

LatestFrame::~LatestFrame() {
  sem_destroy(&fresh_);
}

void LatestFrame::publish() noexcept {
  const unsigned before = middle_.exchange(back_ | kFresh, std::memory_order_acq_rel);
  back_ = before & kIndex;
  if ((before & kFresh) != 0)
    dropped_.fetch_add(1, std::memory_order_relaxed);
  else
    sem_post(&fresh_);
}

void LatestFrame::close() noexcept {
  closed_.store(true, std::memory_order_release);
  sem_post(&fresh_);
}

const DepthFrame* LatestFrame::take(std::chrono::nanoseconds timeout) noexcept {
  using namespace std::chrono;
  timespec deadline{};
  clock_gettime(CLOCK_MONOTONIC, &deadline);
  const auto until =
      seconds(deadline.tv_sec) + nanoseconds(deadline.tv_nsec) + std::clamp<nanoseconds>(timeout, 0ns, 24h);
  deadline.tv_sec = duration_cast<seconds>(until).count();
  deadline.tv_nsec = (until % 1s).count();

  while (sem_trywait(&fresh_) != 0) {
    if (finished() || timeout <= 0ns) return nullptr;
    if (sem_clockwait(&fresh_, CLOCK_MONOTONIC, &deadline) == 0) break;
    if (errno == ETIMEDOUT) return nullptr;
  }
  if ((middle_.load(std::memory_order_acquire) & kFresh) == 0) return nullptr;  // it was the token of the end
  front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
  return &frames_[front_];
}

bool LatestFrame::finished() const noexcept {
  return closed_.load(std::memory_order_acquire) && (middle_.load(std::memory_order_acquire) & kFresh) == 0;
}

}  // namespace armature
