#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace armature {

/// Calls work(i, thread) for every i in [0, count) until stopped() holds; which thread gets which i is left to chance.
template <class Stopped, class Work>
void for_each_in_parallel(std::size_t count, int threads, const Stopped& stopped, const Work& work) {
  std::atomic<std::size_t> next = 0;
  const auto run = [&](std::size_t thread) {
    for (std::size_t i = next++; i < count && !stopped(); i = next++) work(i, thread);
  };
  std::vector<std::jthread> helpers;
  for (int thread = 1; thread < threads; ++thread) helpers.emplace_back(run, static_cast<std::size_t>(thread));
  run(0);
}

/// Adds up the parts of a job as they are done. Thread-safe: yes.
class TrainingProgress {
 public:
  explicit TrainingProgress(std::function<void(double)> report) : report_(std::move(report)) {}
  void add(double part) {
    const std::lock_guard lock(mutex_);
    done_ += part;
    if (report_) report_(std::min(done_, 1.0));
  }

 private:
  std::function<void(double)> report_;
  std::mutex mutex_;
  double done_ = 0;
};

}  // namespace armature
