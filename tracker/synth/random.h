#pragma once

#include <cmath>
#include <cstdint>

#include "tracker/body/rotation.h"

namespace armature {

/// Scrambles a number into one that looks independent of it (the finaliser of SplitMix64, Steele et al. 2014).
[[nodiscard]] constexpr std::uint64_t scrambled(std::uint64_t x) noexcept {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31);
}

/// Seeds with this bit are held out: people drawn from them are for measuring with, never for learning from.
/// TrainingSampler clears the bit, so that whatever it is asked for it draws nobody of them.
inline constexpr std::uint64_t kHeldOut = std::uint64_t{1} << 63U;

/// Random numbers that are the same on every machine: SplitMix64, no library distribution, no libm. Draw one a statement:
/// in which order a call evaluates its arguments is the compiler's to choose, and differs between processors.
class Random {
 public:
  explicit Random(std::uint64_t seed) noexcept : state_(scrambled(seed)) {}

  [[nodiscard]] std::uint64_t bits() noexcept { return scrambled(state_ += 0x9E3779B97F4A7C15ULL); }
  /// In [0, 1).
  [[nodiscard]] double unit() noexcept { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  [[nodiscard]] double uniform(double low, double high) noexcept { return low + (high - low) * unit(); }
  [[nodiscard]] bool chance(double probability) noexcept { return unit() < probability; }
  [[nodiscard]] int below(int count) noexcept { return static_cast<int>(unit() * count); }
  /// Mean 0, variance 1, within +-6: a sum of twelve uniforms.
  [[nodiscard]] double normal() noexcept {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += unit();
    return sum;
  }
  [[nodiscard]] double lognormal(double mean_of_log, double sigma) noexcept {
    return on_grid(std::exp(mean_of_log + sigma * normal()));
  }
  [[nodiscard]] double sign() noexcept { return (bits() & 1) != 0 ? 1.0 : -1.0; }

 private:
  std::uint64_t state_;
};

}  // namespace armature
