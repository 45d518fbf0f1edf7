#include <armature/sdk/expansion/histogram.h>

namespace armature::sdk {

double chi_square(std::span<const float> p, std::span<const float> q) noexcept {
  double sum = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double both = double{p[i]} + q[i];
    const double apart = double{p[i]} - q[i];
    if (both > 0) sum += apart * apart / both;
  }
  return 0.5 * sum;
}

void normalise(std::span<float> histogram) noexcept {
  double sum = 0;
  for (const float mass : histogram) sum += mass;
  if (sum <= 0) return;
  for (float& mass : histogram) mass = static_cast<float>(mass / sum);
}

}  // namespace armature::sdk
