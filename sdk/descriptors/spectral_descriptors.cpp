#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <armature/sdk/descriptors/descriptors.h>

#include "sdk/descriptors/area_means.h"

namespace armature::sdk {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;

/// Unlike by the mean of |a - b| / (a + b), in [0, 1].
class Signature final : public AreaMeans {
 public:
  using AreaMeans::AreaMeans;
  [[nodiscard]] double dissimilarity(std::span<const float> a, std::span<const float> b,
                                     double) const noexcept override {
    if (!both_cover(a, b)) return kNothingAlike;
    double sum = 0;
    for (std::size_t k = 1; k < a.size(); ++k) {
      const float x = a[k] / a[0];
      const float y = b[k] / b[0];
      if (x + y > 0) sum += static_cast<double>(std::abs(x - y) / (x + y));
    }
    return sum / static_cast<double>(count());
  }
};

/// Unlike by the distance over the sum of lengths, in [0, 1].
class Direction final : public AreaMeans {
 public:
  using AreaMeans::AreaMeans;
  [[nodiscard]] double dissimilarity(std::span<const float> a, std::span<const float> b,
                                     double) const noexcept override {
    if (!both_cover(a, b)) return kNothingAlike;
    double apart = 0, x2 = 0, y2 = 0;
    for (std::size_t k = 1; k < a.size(); ++k) {
      const auto x = static_cast<double>(a[k] / a[0]);
      const auto y = static_cast<double>(b[k] / b[0]);
      apart += (x - y) * (x - y);
      x2 += x * x;
      y2 += y * y;
    }
    return apart > 0 ? std::sqrt(apart) / (std::sqrt(x2) + std::sqrt(y2)) : 0;
  }
};

/// The first value that is not of a constant function, of which every component has one; 0 if there is none.
double first_positive(const Spectrum& spectrum, const Laplacian& laplacian) {
  // Beside what Weyl's law expects of the highest, which is not 0 even if all are.
  const double none = 1e-8 * 4 * std::numbers::pi * static_cast<double>(spectrum.values.size()) / laplacian.mass.sum();
  for (const double value : spectrum.values)
    if (value > none) return value;
  return 0;
}

std::vector<double> areas_of(const Laplacian& laplacian) {
  return {laplacian.mass.begin(), laplacian.mass.end()};
}

/// Row v: the sum over k of weights(k, j) phi_k(v)^2, for every j; [V][j].
std::vector<float> squares(const Spectrum& spectrum, const Eigen::MatrixXd& weights) {
  std::vector<float> rows(static_cast<std::size_t>(spectrum.functions.rows() * weights.cols()));
  using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Map<Rows>(rows.data(), spectrum.functions.rows(), weights.cols()) =
      (spectrum.functions.cwiseAbs2() * weights).cast<float>();
  return rows;
}

}  // namespace

std::unique_ptr<Descriptor> heat_kernel_signature(const Spectrum& spectrum, const Laplacian& laplacian) {
  constexpr Index kTimes = 16;
  const double top = spectrum.values[spectrum.values.size() - 1];
  const double low = first_positive(spectrum, laplacian);
  Eigen::MatrixXd weights(spectrum.values.size(), kTimes);
  for (Index j = 0; j < kTimes; ++j) {
    const double at = static_cast<double>(j) / (kTimes - 1);
    const double t = low > 0 ? 4 * std::numbers::ln10 / top * std::pow(top / low, at) : 1;
    const ArrayXd heat = (-t * spectrum.values.array()).exp();
    weights.col(j) = heat / heat.sum();
  }
  return std::make_unique<Signature>(squares(spectrum, weights), kTimes, areas_of(laplacian));
}

std::unique_ptr<Descriptor> scale_invariant_heat_kernel_signature(const Spectrum& spectrum,
                                                                  const Laplacian& laplacian) {
  // Times alpha^tau; what a change of size shifts along tau, the Fourier magnitudes do not see.
  constexpr Index kTimes = 96;
  constexpr std::size_t kFrequencies = 12;
  const double top = spectrum.values[spectrum.values.size() - 1];
  const double low = first_positive(spectrum, laplacian);
  const Index n = spectrum.functions.rows();
  Eigen::MatrixXd weights(spectrum.values.size(), kTimes);
  for (Index j = 0; j < kTimes; ++j) {
    const double at = static_cast<double>(j) / (kTimes - 1);
    const double t = low > 0 ? 1 / top * std::pow(100 * top / low, at) : 1;
    weights.col(j) = (-t * spectrum.values.array()).exp();
  }
  const std::vector<float> heat = squares(spectrum, weights);
  std::vector<float> rows(static_cast<std::size_t>(n) * kFrequencies);
  for (std::size_t v = 0; v < static_cast<std::size_t>(n); ++v) {
    const auto h = std::span(heat).subspan(v * kTimes, kTimes);
    for (std::size_t f = 0; f < kFrequencies; ++f) {
      std::complex<double> sum = 0;
      for (std::size_t j = 0; j + 1 < h.size(); ++j) {
        if (!(h[j] > 0 && h[j + 1] > 0)) continue;
        const double step = std::log(static_cast<double>(h[j + 1])) - std::log(static_cast<double>(h[j]));
        sum += step * std::polar(1.0, -2 * std::numbers::pi * static_cast<double>(f * j) / (kTimes - 1));
      }
      rows[v * kFrequencies + f] = static_cast<float>(std::abs(sum));
    }
  }
  return std::make_unique<Direction>(std::move(rows), kFrequencies, areas_of(laplacian));
}

std::unique_ptr<Descriptor> wave_kernel_signature(const Spectrum& spectrum, const Laplacian& laplacian) {
  constexpr Index kEnergies = 32;
  constexpr double kVariance = 7;  // in steps of energy
  const double low = first_positive(spectrum, laplacian);
  const Index k = spectrum.values.size();
  const double first = low > 0 ? std::log(low) : 0;
  const double last = low > 0 ? std::log(spectrum.values[k - 1]) / 1.02 + (1 - 1 / 1.02) * first : 0;
  const double step = (last - first) / kEnergies;
  const double sigma = kVariance * step;
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(k, kEnergies);
  for (Index j = 0; j < kEnergies && sigma > 0; ++j) {
    const double energy = first + 2 * sigma + (last - first - 4 * sigma) * static_cast<double>(j) / (kEnergies - 1);
    for (Index i = 0; i < k; ++i) {
      if (!(spectrum.values[i] >= low)) continue;
      const double off = energy - std::log(spectrum.values[i]);
      weights(i, j) = std::exp(-off * off / (2 * sigma * sigma));
    }
    weights.col(j) /= weights.col(j).sum();
  }
  return std::make_unique<Signature>(squares(spectrum, weights), kEnergies, areas_of(laplacian));
}

}  // namespace armature::sdk
