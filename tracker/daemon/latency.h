#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>

namespace armature {

/// The last so many latencies, and their percentiles on demand. Realtime-safe: add() yes.
class Latency {
 public:
  void add(std::chrono::nanoseconds latency) noexcept { last_[count_++ % last_.size()] = latency; }

  /// The latency that `share` of the last ones did not exceed; zero where there are none.
  [[nodiscard]] std::chrono::nanoseconds percentile(double share) const noexcept {
    const std::size_t known = std::min(count_, last_.size());
    if (known == 0) return {};
    auto sorted = last_;
    const auto rank = std::min(known - 1, static_cast<std::size_t>(share * static_cast<double>(known)));
    const auto nth = sorted.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(sorted.begin(), nth, sorted.begin() + static_cast<std::ptrdiff_t>(known));
    return *nth;
  }

 private:
  std::array<std::chrono::nanoseconds, 256> last_{};
  std::size_t count_ = 0;
};

}  // namespace armature
