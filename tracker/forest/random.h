#pragma once

#include <cstdint>

namespace armature {

/// SplitMix64 (Steele, Lea and Flood 2014): the same numbers on every machine, and any seed is a good one.
class TrainingRandom {
 public:
  explicit TrainingRandom(std::uint64_t seed) : state_(seed) {}
  [[nodiscard]] std::uint64_t next() noexcept {
    state_ += 0x9E3779B97F4A7C15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31U);
  }
  /// Uniform in [0, n).
  [[nodiscard]] std::uint32_t below(std::uint32_t n) noexcept {
    return static_cast<std::uint32_t>(((next() >> 32U) * n) >> 32U);
  }
  /// Uniform in [low, high].
  [[nodiscard]] int between(int low, int high) noexcept {
    return low + static_cast<int>(below(static_cast<std::uint32_t>(high - low + 1)));
  }

 private:
  std::uint64_t state_;
};

/// The seed of one part of a job, from that of the whole job and the part's number.
[[nodiscard]] inline std::uint64_t derive_seed(std::uint64_t seed, std::uint64_t part) noexcept {
  return TrainingRandom(seed ^ (part * 0xD1342543DE82EF95ULL + 0x632BE59BD9B4E019ULL)).next();
}

}  // namespace armature
