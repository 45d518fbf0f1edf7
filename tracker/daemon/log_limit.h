#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace armature {

/// Lets so many lines of a kind through in a row and then one a period: what repeats fills no disk. Thread-safe: no.
class LogLimit {
 public:
  static constexpr std::size_t kKinds = 32;
  static constexpr int kBurst = 10;
  static constexpr std::chrono::seconds kPeriod{10};

  /// Whether a line of this kind may be written now; `held_back` is how many were not since the last one that was.
  [[nodiscard]] bool admit(std::size_t kind, std::chrono::nanoseconds now, std::uint64_t& held_back) noexcept {
    Kind& k = kinds_[kind % kKinds];
    if (now - k.refilled >= kPeriod) {
      const auto periods = (now - k.refilled) / kPeriod;
      k.left = static_cast<int>(periods > kBurst ? kBurst : k.left + periods > kBurst ? kBurst : k.left + periods);
      k.refilled = now;
    }
    if (k.left == 0) {
      ++k.held_back;
      return false;
    }
    --k.left;
    held_back = k.held_back;
    k.held_back = 0;
    return true;
  }

 private:
  struct Kind {
    int left = kBurst;
    std::chrono::nanoseconds refilled{0};
    std::uint64_t held_back = 0;
  };
  std::array<Kind, kKinds> kinds_{};
};

}  // namespace armature
