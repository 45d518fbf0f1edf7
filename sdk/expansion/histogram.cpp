#include <array>
#include <cstddef>

#include <armature/sdk/expansion/histogram.h>

namespace armature::sdk {

double chi_square(std::span<const float> p, std::span<const float> q) noexcept {
  // In lanes, which the compiler keeps in one register.
  constexpr std::size_t kLanes = 4;
  std::array<double, kLanes> sums{};
  const auto add = [&](std::size_t lane, std::size_t i) {
    const double both = double{p[i]} + q[i];
    const double apart = double{p[i]} - q[i];
    sums[lane] += apart * apart / (both > 0 ? both : 1);
  };
  std::size_t i = 0;
  for (; i + kLanes <= p.size(); i += kLanes)
    for (std::size_t lane = 0; lane < kLanes; ++lane) add(lane, i + lane);
  for (; i < p.size(); ++i) add(0, i);
  return 0.5 * ((sums[0] + sums[1]) + (sums[2] + sums[3]));
}

void normalise(std::span<float> histogram) noexcept {
  double sum = 0;
  for (const float mass : histogram) sum += mass;
  if (sum <= 0) return;
  for (float& mass : histogram) mass = static_cast<float>(mass / sum);
}

}  // namespace armature::sdk
