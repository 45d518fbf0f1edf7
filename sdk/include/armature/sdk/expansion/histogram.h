#pragma once

#include <span>
#include <vector>

namespace armature::sdk {

/// How area spreads over bins, row-major where there are two dimensions. Those that are compared have the same bins and
/// sum to 1, or hold zeros alone.
using Histogram = std::vector<float>;

/// 1/2 sum (p - q)^2 / (p + q), with 0/0 = 0: in [0, 1] for histograms that sum to 1, 0 for equal ones.
[[nodiscard]] double chi_square(std::span<const float> p, std::span<const float> q) noexcept;

/// Divides by the sum; zeros stay.
void normalise(std::span<float> histogram) noexcept;

}  // namespace armature::sdk
