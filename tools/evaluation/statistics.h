#pragma once

#include <span>
#include <vector>

namespace armature::tools {

/// The p-th percentile (p in [0, 100], nearest rank); 0 of nothing. Reorders the values.
[[nodiscard]] double percentile(std::vector<double>& values, double p);

[[nodiscard]] double mean(std::span<const double> values);

/// Pearson's; 0 where either side is constant.
[[nodiscard]] double correlation(std::span<const double> a, std::span<const double> b);

/// By how much `y` rises where `x` rises by one, by the least squares; 0 where `x` is constant.
[[nodiscard]] double slope(std::span<const double> x, std::span<const double> y);

/// A guess with its confidence, and whether it was right.
struct Detection {
  double confidence = 0;
  bool right = false;
};

/// The area under precision over recall, `truths` being how many there were to find. Reorders the detections.
[[nodiscard]] double average_precision(std::vector<Detection>& detections, std::size_t truths);

}  // namespace armature::tools
