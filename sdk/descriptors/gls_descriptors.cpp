#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <armature/sdk/descriptors/descriptors.h>
#include <tbb/parallel_for.h>

#include "sdk/descriptors/area_means.h"
#include "sdk/descriptors/gls_fit.h"

namespace armature::sdk {
namespace {

constexpr std::size_t kParameters = 3;  // tau / t, t kappa, phi: without unit

std::vector<double> areas_of(const PointSet& points) {
  if (!points.areas.empty()) return points.areas;
  // As on a grid of that spacing.
  const double apart = spacing(points);
  return std::vector<double>(points.positions.size(), apart > 0 ? apart * apart : 1.0);
}

std::array<float, kParameters> parameters(const Gls& gls, double t) {
  return {static_cast<float>(gls.tau / t), static_cast<float>(gls.kappa * t), static_cast<float>(gls.phi)};
}

/// [V][scale][parameter].
Expected<std::vector<float>> all_parameters(const GrowingLeastSquares& gls, const Task& task) {
  const std::size_t scales = gls.scales().size();
  std::vector<float> rows(gls.points().positions.size() * scales * kParameters);
  for (std::size_t j = 0; j < scales; ++j) {
    task.report("fitting spheres", static_cast<double>(j) / static_cast<double>(scales));
    const auto fits = gls.at_points(j, {.stop = task.stop});  // whose progress is that of one scale
    if (!fits) return tl::unexpected(fits.error());
    for (std::size_t v = 0; v < fits->size(); ++v)
      std::ranges::copy(parameters((*fits)[v], gls.scales()[j]),
                        rows.begin() + static_cast<std::ptrdiff_t>((v * scales + j) * kParameters));
  }
  return rows;
}

/// Equation 6.2, over the number of scales.
class GlsMean final : public AreaMeans {
 public:
  using AreaMeans::AreaMeans;
  [[nodiscard]] double dissimilarity(std::span<const float> a, std::span<const float> b,
                                     double) const noexcept override {
    if (!both_cover(a, b)) return kNothingAlike;
    float sum = 0;
    for (std::size_t k = 1; k < a.size(); ++k) {
      const float off = a[k] / a[0] - b[k] / b[0];
      sum += off * off;
    }
    return static_cast<double>(sum) * kParameters / static_cast<double>(count());
  }
};

/// A region is its area; the first and second moments of every column's bins; the bins: areas all. A vertex is shared
/// between the two bins whose middles its value lies between, so that noise moves little.
class GlsHistograms final : public Descriptor {
 public:
  GlsHistograms(std::span<const float> parameters, std::span<const double> scales, std::span<const double> areas,
                bool scaled)
      : columns_(scales.size() * kParameters),
        areas_(areas.begin(), areas.end()),
        scales_(scales.begin(), scales.end()),
        scaled_(scaled) {
    std::array<std::pair<float, float>, kParameters> range;
    for (std::size_t p = 0; p < kParameters; ++p) range[p] = usual_range(parameters, p);
    places_.resize(parameters.size());
    for (std::size_t k = 0; k < places_.size(); ++k) {
      const auto [least, most] = range[k % kParameters];
      const float at = most > least ? (parameters[k] - least) / (most - least) : 0.0F;
      const float place = std::clamp(at * kGlsBins - 0.5F, 0.0F, kGlsBins - 1.0F);
      places_[k] = static_cast<std::uint16_t>(std::lround(place * kPlaces));
    }
  }

  [[nodiscard]] std::size_t size() const noexcept override { return areas_.size(); }
  [[nodiscard]] std::size_t width() const noexcept override { return 1 + 2 * columns_ + columns_ * kGlsBins; }
  void describe(VertexId vertex, std::span<float> out) const noexcept override {
    std::ranges::fill(out, 0.0F);
    add(out, vertex);
  }
  void add(std::span<float> into, VertexId vertex) const noexcept override {
    const float area = areas_[vertex.index()];
    into[0] += area;
    for (std::size_t c = 0; c < columns_; ++c) {
      const float x = static_cast<float>(places_[vertex.index() * columns_ + c]) / kPlaces;
      const auto low = static_cast<std::size_t>(x);
      const float high_share = x - static_cast<float>(low);
      const float at_low = area * (1 - high_share);
      const float at_high = area * high_share;
      float* const bins = into.data() + 1 + 2 * columns_ + c * kGlsBins;
      bins[low] += at_low;
      if (low + 1 < kGlsBins) bins[low + 1] += at_high;
      const auto l = static_cast<float>(low);
      into[1 + c] += area * x;
      into[1 + columns_ + c] += at_low * l * l + at_high * (l + 1) * (l + 1);
    }
  }
  [[nodiscard]] double dissimilarity(std::span<const float> a, std::span<const float> b,
                                     double limit) const noexcept override {
    if (!both_cover(a, b)) return kNothingAlike;
    const float to_a = 1 / a[0];
    const float to_b = 1 / b[0];
    // With f the place among the bins less that between the means, Cauchy and Schwarz give (sum f (p - q))^2 <=
    // sum f^2 (p + q) times twice chi-square: a bound by means and variances alone.
    float bound = 0;
    float all = 0;
    for (std::size_t c = 0; c < columns_; ++c) {
      const float weight = weight_of(c, a[0] + b[0]);
      const float mean_a = a[1 + c] * to_a;
      const float mean_b = b[1 + c] * to_b;
      const float off = (mean_a - mean_b) * (mean_a - mean_b);
      const float variance = std::max(0.0F, a[1 + columns_ + c] * to_a - mean_a * mean_a) +
                             std::max(0.0F, b[1 + columns_ + c] * to_b - mean_b * mean_b);
      bound += weight * (off / (2 * variance + off + kTiny));
      all += weight;
    }
    if (static_cast<double>(bound / all) >= limit * kRounding) return static_cast<double>(bound / all);
    float sum = 0;
    for (std::size_t c = 0; c < columns_; ++c) {
      const float* p = a.data() + 1 + 2 * columns_ + c * kGlsBins;
      const float* q = b.data() + 1 + 2 * columns_ + c * kGlsBins;
      float chi = 0;
      for (std::size_t k = 0; k < kGlsBins; ++k) {
        const float x = p[k] * to_a;
        const float y = q[k] * to_b;
        chi += (x - y) * (x - y) / (x + y + kTiny);
      }
      sum += weight_of(c, a[0] + b[0]) * chi;
    }
    return static_cast<double>(0.5F * sum / all);
  }
  [[nodiscard]] double area(std::span<const float> region) const noexcept override {
    return static_cast<double>(region[0]);
  }
  [[nodiscard]] double area(VertexId vertex) const noexcept override {
    return static_cast<double>(areas_[vertex.index()]);
  }

 private:
  static constexpr float kPlaces = 4096;
  static constexpr float kTiny = 1e-20F;       // 0 / 0 = 0
  static constexpr double kRounding = 1.0001;  // of the bound, in floats

  /// A scale counts by (t/r)^2 where r is the radius of a disc as large as the regions' mean.
  [[nodiscard]] float weight_of(std::size_t column, float area_of_both) const noexcept {
    if (!scaled_) return 1;
    const auto t = static_cast<float>(scales_[column / kParameters]);
    return std::min(1.0F, t * t / (area_of_both / (2 * std::numbers::pi_v<float>)));
  }

  /// The 1st and the 99th percentile of a parameter over all scales.
  static std::pair<float, float> usual_range(std::span<const float> parameters, std::size_t parameter) {
    std::vector<float> values;
    values.reserve(parameters.size() / kParameters);
    for (std::size_t k = parameter; k < parameters.size(); k += kParameters) values.push_back(parameters[k]);
    const auto percentile = [&](std::size_t percent) {
      const auto at = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) * percent / 100);
      std::ranges::nth_element(values, at);
      return *at;
    };
    const float least = percentile(1);
    return {least, percentile(99)};
  }

  std::size_t columns_;  // scales times parameters
  std::vector<float> areas_;
  std::vector<double> scales_;
  std::vector<std::uint16_t> places_;  // [V][scale][parameter]: among the middles of the bins, in 1 / kPlaces
  bool scaled_;
};

/// A region is its area, a place, the integral of positions about that place, and by scale the sums of its fit there,
/// which are those of its vertices weighted by area.
class GlsMerged final : public Descriptor {
 public:
  GlsMerged(const GrowingLeastSquares& gls, std::span<const double> areas, const Task& task)
      : scales_(gls.scales().begin(), gls.scales().end()), size_(areas.size()), rows_(areas.size() * width()) {
    const auto& positions = gls.points().positions;
    constexpr std::size_t kBlock = 256;
    tbb::parallel_for(std::size_t{0}, (size_ + kBlock - 1) / kBlock, [&](std::size_t block) {
      for (std::size_t v = block * kBlock; v < std::min(size_, (block + 1) * kBlock) && !task.stopped(); ++v) {
        const auto row = std::span(rows_).subspan(v * width(), width());
        const double area = areas[v];
        row[0] = static_cast<float>(area);
        Eigen::Map<Eigen::Vector3f>(row.data() + 1) = (positions[v] - positions[0]).cast<float>();
        for (std::size_t j = 0; j < scales_.size(); ++j) {
          GlsSums sums = neighbourhood_sums(gls, positions[v], j);
          if (!(sums.weight > 0)) continue;
          const double share = area / sums.weight;
          write({.weight = share * sums.weight,
                 .p = share * sums.p,
                 .n = share * sums.n,
                 .pn = share * sums.pn,
                 .pp = share * sums.pp},
                row, j);
        }
      }
    });
  }

  [[nodiscard]] std::size_t size() const noexcept override { return size_; }
  [[nodiscard]] std::size_t width() const noexcept override { return kFirst + kSums * scales_.size(); }
  void describe(VertexId vertex, std::span<float> out) const noexcept override {
    std::ranges::copy(row(vertex), out.begin());
  }
  void add(std::span<float> into, VertexId vertex) const noexcept override { aggregate(into, row(vertex)); }
  void aggregate(std::span<float> into, std::span<const float> other) const noexcept override {
    const Eigen::Vector3f apart =
        Eigen::Map<const Eigen::Vector3f>(other.data() + 1) - Eigen::Map<const Eigen::Vector3f>(into.data() + 1);
    Eigen::Map<Eigen::Vector3f>(into.data() + 4) +=
        Eigen::Map<const Eigen::Vector3f>(other.data() + 4) + other[0] * apart;
    into[0] += other[0];
    for (std::size_t j = 0; j < scales_.size(); ++j) {
      GlsSums sums = read(into, j);
      sums += read(other, j).about(-apart.cast<double>());
      write(sums, into, j);
    }
  }
  [[nodiscard]] double dissimilarity(std::span<const float> a, std::span<const float> b,
                                     double limit) const noexcept override {
    if (!both_cover(a, b)) return kNothingAlike;
    double sum = 0;
    const auto scales = static_cast<double>(scales_.size());
    for (std::size_t j = scales_.size(); j-- > 0 && sum < limit * scales;)
      sum += gls_dissimilarity(at_middle(a, j), at_middle(b, j), scales_[j]);
    return sum / scales;
  }
  [[nodiscard]] double area(std::span<const float> region) const noexcept override {
    return static_cast<double>(region[0]);
  }
  [[nodiscard]] double area(VertexId vertex) const noexcept override { return area(row(vertex)); }

 private:
  static constexpr std::size_t kFirst = 7, kSums = 9;

  [[nodiscard]] std::span<const float> row(VertexId vertex) const noexcept {
    return std::span(rows_).subspan(vertex.index() * width(), width());
  }

  static GlsSums read(std::span<const float> row, std::size_t scale) noexcept {
    std::array<double, kSums> s{};
    std::ranges::copy(row.subspan(kFirst + kSums * scale, kSums), s.begin());
    return {.weight = s[0], .p = {s[1], s[2], s[3]}, .n = {s[4], s[5], s[6]}, .pn = s[7], .pp = s[8]};
  }
  static void write(const GlsSums& s, std::span<float> row, std::size_t scale) noexcept {
    const std::array<double, kSums> all = {s.weight, s.p[0], s.p[1], s.p[2], s.n[0], s.n[1], s.n[2], s.pn, s.pp};
    for (std::size_t k = 0; k < kSums; ++k) row[kFirst + kSums * scale + k] = static_cast<float>(all[k]);
  }
  /// Seen from the middle of the region.
  static Gls at_middle(std::span<const float> row, std::size_t scale) noexcept {
    const Eigen::Vector3f middle = Eigen::Map<const Eigen::Vector3f>(row.data() + 4) / row[0];
    return gls_of(fit_sphere(read(row, scale).about(middle.cast<double>())));
  }

  std::vector<double> scales_;
  std::size_t size_;
  std::vector<float> rows_;
};

}  // namespace

Expected<std::unique_ptr<Descriptor>> gls_descriptor(const GrowingLeastSquares& gls, GlsAggregation aggregation,
                                                     const Task& task) {
  const std::vector<double> areas = areas_of(gls.points());
  if (aggregation == GlsAggregation::Merged) {
    auto merged = std::make_unique<GlsMerged>(gls, areas, task);
    if (task.stopped()) return cancelled();
    return merged;
  }
  auto parameters = all_parameters(gls, task);
  if (!parameters) return tl::unexpected(parameters.error());
  const std::size_t columns = gls.scales().size() * kParameters;
  if (aggregation == GlsAggregation::Mean) return std::make_unique<GlsMean>(std::move(*parameters), columns, areas);
  return std::make_unique<GlsHistograms>(*parameters, gls.scales(), areas,
                                         aggregation == GlsAggregation::ScaledHistograms);
}

}  // namespace armature::sdk
