#include "tools/evaluation/statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace armature::tools {

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
  const double mean_a = mean(a), mean_b = mean(b);
  double aa = 0, bb = 0, ab = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
    ab += (a[i] - mean_a) * (b[i] - mean_b);
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
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
