#include "tracker/forest/split_search.h"

#include <algorithm>
#include <array>
#include <bit>

namespace armature {
namespace {

constexpr int kBins = FeatureBins::kBins;
constexpr int kMinRange_mm = 40, kMaxRange_mm = 800;
constexpr std::size_t kChunk = 256;          // samples whose rows fit into the second-level cache together
constexpr std::size_t kFeaturesAtOnce = 16;  // features whose histograms fit into the first-level cache together
constexpr std::size_t kColumnsAtOnce = 4;    // a histogram's rows are padded to eight bytes

/// floor(4096 log2 n), bit by bit: a library's log2 may differ between machines.
std::uint64_t log2_in_4096ths(std::uint32_t n) {
  const auto whole = static_cast<std::uint64_t>(std::bit_width(n) - 1);
  std::uint64_t mantissa = (std::uint64_t{n} << 31U) >> whole;  // in [1, 2), 31 fractional bits
  std::uint64_t result = whole;
  for (int bit = 0; bit < 12; ++bit) {
    mantissa = (mantissa * mantissa) >> 31U;
    const bool above = mantissa >= (std::uint64_t{2} << 31U);
    if (above) mantissa >>= 1U;
    result = 2 * result + (above ? 1 : 0);
  }
  return result;
}

/// Only parts that occur have a column in the histograms.
struct Columns {
  std::array<std::uint16_t, kPartCount> of_part{};
  std::array<std::int64_t, kPartCount> total{};  // samples in each column
  std::size_t used = 0, padded = 0;
};

Columns columns_of(const PartCounts& parts) {
  Columns columns;
  for (std::size_t part = 0; part < kPartCount; ++part) {
    if (parts[part] == 0) continue;
    columns.of_part[part] = static_cast<std::uint16_t>(columns.used);
    columns.total[columns.used++] = parts[part];
  }
  columns.padded = (columns.used + kColumnsAtOnce - 1) / kColumnsAtOnce * kColumnsAtOnce;
  return columns;
}

}  // namespace

SplitSearch::SplitSearch(const TrainerOptions& options) : options_(options) {
  n_log_n_.push_back(0);
}

std::size_t SplitSearch::histogram_size(const SearchedNode& node) const noexcept {
  return static_cast<std::size_t>(options_.features_per_node) * kBins * columns_of(node.parts).padded;
}

void SplitSearch::draw_features(std::uint64_t seed) {
  if (drawn_seed_ == seed) return;
  drawn_seed_ = seed;
  TrainingRandom random(seed);
  // Uniform in a disc that is itself shrunk at random: denser near zero.
  const auto probe_mm = [&] {
    const int reach = random.between(1, options_.max_probe_mm);
    int x = 0, y = 0;
    do {
      x = random.between(-reach, reach);
      y = random.between(-reach, reach);
    } while (x * x + y * y > reach * reach);
    return std::array{static_cast<std::int16_t>(x), static_cast<std::int16_t>(y)};
  };
  drawn_.resize(static_cast<std::size_t>(options_.features_per_node));
  std::uint32_t number = 0;
  for (CandidateFeature& feature : drawn_) {
    feature = {};
    feature.number = number++;
    feature.node.u_mm = probe_mm();
    if (random.below(2) == 0) feature.node.v_mm = probe_mm();
    feature.step_mm = random.between(kMinRange_mm, kMaxRange_mm) / FeatureBins::kHalf;
  }
  bins_.assign(drawn_);
}

void SplitSearch::count(std::span<const TrainingPerson> persons, std::span<const TrainingSample> samples,
                        const SearchedNode& node, std::span<std::uint16_t> histograms) {
  draw_features(node.seed);
  const Columns columns = columns_of(node.parts);
  const std::size_t features = bins_.features().size();
  const std::size_t stride = bins_.stride();
  const std::size_t size = kBins * columns.padded;  // of one histogram
  std::fill(histograms.begin(), histograms.end(), std::uint16_t{0});
  rows_.resize(kChunk * stride);
  for (std::size_t begin = 0; begin < samples.size(); begin += kChunk) {
    const auto chunk = samples.subspan(begin, std::min(kChunk, samples.size() - begin));
    bins_.find(persons, chunk, static_cast<std::uint16_t>(columns.padded), columns.of_part, rows_.data());
    for (std::size_t first = 0; first < features; first += kFeaturesAtOnce) {
      const std::size_t count = std::min(kFeaturesAtOnce, features - first);
      std::uint16_t* const histogram = histograms.data() + first * size;
      for (std::size_t i = 0; i < chunk.size(); ++i) {
        const std::uint16_t* const row = rows_.data() + i * stride + first;
        for (std::size_t f = 0; f < count; ++f) ++histogram[f * size + row[f]];
      }
    }
  }
}

std::optional<SplitNode> SplitSearch::best(const SearchedNode& node, std::span<const std::uint16_t> histograms) {
  draw_features(node.seed);
  const Columns columns = columns_of(node.parts);
  const std::int64_t count = total(node.parts);
  for (auto n = static_cast<std::uint32_t>(n_log_n_.size()); n <= count; ++n) {
    n_log_n_.push_back(static_cast<std::uint32_t>(n * log2_in_4096ths(n)));
  }

  // A child must get its share of the samples that a leaf needs.
  const std::int64_t fewest = std::max<std::int64_t>(1, options_.min_leaf_samples * count / node.samples);
  // Purity = sum of n log n over the parts of a child, minus that of the child: the negated entropy.
  std::int64_t best = -std::int64_t{n_log_n(count)};
  for (std::size_t column = 0; column < columns.used; ++column) best += n_log_n(columns.total[column]);
  const CandidateFeature* found = nullptr;
  int found_bin = 0;
  const std::uint16_t* row = histograms.data();
  for (const CandidateFeature& feature : bins_.features()) {
    std::array<std::uint32_t, kPartCount + 1> left{};
    std::uint32_t left_count = 0;
    const std::uint16_t* const end = row + kBins * columns.padded;
    for (int bin = 1; bin < kBins; ++bin, row += columns.padded) {
      std::uint32_t added = 0;
      for (std::size_t column = 0; column < columns.padded; ++column) {
        left[column] += row[column];
        added += row[column];
      }
      left_count += added;
      if (added == 0 || left_count < fewest) continue;
      if (count - left_count < fewest) break;
      std::int64_t purity = -(std::int64_t{n_log_n(left_count)} + n_log_n(count - left_count));
      for (std::size_t column = 0; column < columns.used; ++column) {
        purity += n_log_n(left[column]) + n_log_n(columns.total[column] - left[column]);
      }
      // Of equals the feature that was drawn first, whatever order they are in.
      if (purity < best || (purity == best && (found == nullptr || found->number <= feature.number))) continue;
      best = purity;
      found = &feature;
      found_bin = bin;
    }
    row = end;
  }
  if (found == nullptr) return {};
  SplitNode split = found->node;
  split.threshold_mm = static_cast<std::int16_t>((found_bin - FeatureBins::kHalf) * found->step_mm);
  return split;
}

}  // namespace armature
