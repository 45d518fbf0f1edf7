#include "tools/evaluation/statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace armature::tools {
namespace {

/// Sums of products of what two lists are beside their means.
struct Products {
  double aa = 0, bb = 0, ab = 0;
};

Products products(std::span<const double> a, std::span<const double> b) {
  const double mean_a = mean(a), mean_b = mean(b);
  Products sums;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sums.aa += (a[i] - mean_a) * (a[i] - mean_a);
    sums.bb += (b[i] - mean_b) * (b[i] - mean_b);
    sums.ab += (a[i] - mean_a) * (b[i] - mean_b);
  }
  return sums;
}

}  // namespace

double percentile(std::vector<double>& values, double p) {
  if (values.empty()) return 0;
  const double rank = std::ceil(p / 100 * static_cast<double>(values.size()));
  const auto i = static_cast<std::ptrdiff_t>(std::clamp(rank, 1.0, static_cast<double>(values.size()))) - 1;
  std::nth_element(values.begin(), values.begin() + i, values.end());
  return values[static_cast<std::size_t>(i)];
}

double mean(std::span<const double> values) {
  if (values.empty()) return 0;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double correlation(std::span<const double> a, std::span<const double> b) {
  const Products sums = products(a, b);
  return sums.aa > 0 && sums.bb > 0 ? sums.ab / std::sqrt(sums.aa * sums.bb) : 0;
}

double slope(std::span<const double> x, std::span<const double> y) {
  const Products sums = products(x, y);
  return sums.aa > 0 ? sums.ab / sums.aa : 0;
}

double average_precision(std::vector<Detection>& detections, std::size_t truths) {
  if (truths == 0) return 0;
  std::stable_sort(detections.begin(), detections.end(),
                   [](const Detection& a, const Detection& b) { return a.confidence > b.confidence; });
  double area = 0;
  std::size_t right = 0;
  for (std::size_t i = 0; i < detections.size(); ++i) {
    if (!detections[i].right) continue;
    ++right;
    area += static_cast<double>(right) / static_cast<double>(i + 1);
  }
  return area / static_cast<double>(truths);
}

}  // namespace armature::tools
