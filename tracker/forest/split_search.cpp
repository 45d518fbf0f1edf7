#include "tracker/forest/split_search.h"

#include <algorithm>
#include <array>
#include <bit>

namespace armature {
namespace {

constexpr int kBins = 24;
constexpr int kHalf = kBins / 2;
constexpr std::size_t kParts = 32;  // kPartCount, rounded up for its address arithmetic
constexpr std::size_t kBlock = 64;  // features whose histograms fit into the second-level cache together
constexpr int kReciprocalBits = 20;
constexpr int kMinRange_mm = 40, kMaxRange_mm = 800;

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

std::span<const TrainingSample> thin(std::span<const TrainingSample> samples, std::size_t most,
                                     std::vector<TrainingSample>& scratch) {
  if (samples.size() <= most) return samples;
  scratch.resize(most);
  for (std::size_t i = 0; i < most; ++i) scratch[i] = samples[i * samples.size() / most];
  return scratch;
}

}  // namespace

SplitSearch::SplitSearch(const TrainingOptions& options) : options_(options) {
  histogram_.resize(kBlock * kBins * kParts);
  n_log_n_.resize(static_cast<std::size_t>(options.node_samples) + 1);
  for (std::uint32_t n = 1; n < n_log_n_.size(); ++n) {
    n_log_n_[n] = static_cast<std::uint32_t>(n * log2_in_4096ths(n));
  }
}

SplitSearch::Feature SplitSearch::random_feature(TrainingRandom& random) const {
  // Uniform in a disc that is itself shrunk at random: denser near zero.
  const auto probe_mm = [&] {
    std::array<std::int16_t, 2> offset{};
    const int reach = random.between(1, options_.max_probe_mm);
    int x = 0, y = 0;
    do {
      x = random.between(-reach, reach);
      y = random.between(-reach, reach);
    } while (x * x + y * y > reach * reach);
    offset = {static_cast<std::int16_t>(x), static_cast<std::int16_t>(y)};
    return offset;
  };
  Feature feature;
  feature.node.u_mm = probe_mm();
  if (random.below(2) == 0) feature.node.v_mm = probe_mm();
  feature.step_mm = std::max(1, random.between(kMinRange_mm, kMaxRange_mm) / kHalf);
  feature.reciprocal = (1 << kReciprocalBits) / feature.step_mm + 1;
  return feature;
}

void SplitSearch::fill_histograms(std::span<const TrainingPerson> persons, std::span<const Feature> features) {
  std::fill_n(histogram_.begin(), features.size() * kBins * kParts, std::uint16_t{0});
  for (const TrainingSample& sample : chosen_) {
    const TrainingPerson& person = persons[sample.person];
    const PersonImage image = person.image();
    const ProbeScale scale = probe_scale(person.focal, image.depth_mm[sample.v * image.width + sample.u]);
    std::uint16_t* bins = histogram_.data() + sample.part;
    for (const Feature& feature : features) {
      const int f = part_feature(image, sample.u, sample.v, scale, feature.node);
      const int last = kBins * feature.step_mm - 1;
      const int shifted = std::clamp(f + kHalf * feature.step_mm, 0, last);
      const int bin = (shifted * feature.reciprocal) >> kReciprocalBits;
      ++bins[static_cast<std::size_t>(bin) * kParts];
      bins += kBins * kParts;
    }
  }
}

std::optional<SplitNode> SplitSearch::find(std::span<const TrainingPerson> persons,
                                           std::span<const TrainingSample> samples, TrainingRandom random) {
  std::vector<TrainingSample> scratch;
  const auto thinned = thin(samples, static_cast<std::size_t>(options_.node_samples), scratch);
  chosen_.assign(thinned.begin(), thinned.end());

  std::array<std::uint32_t, kParts> total{};
  for (const TrainingSample& sample : chosen_) ++total[sample.part];
  std::array<std::size_t, kParts> present{};
  std::size_t present_count = 0;
  for (std::size_t part = 0; part < kParts; ++part) {
    if (total[part] != 0) present[present_count++] = part;
  }
  if (present_count < 2) return {};

  features_.clear();
  for (int i = 0; i < options_.features_per_node; ++i) features_.push_back(random_feature(random));

  const auto count = static_cast<std::uint32_t>(chosen_.size());
  // A child must get its share of the samples that a leaf needs.
  const auto fewest = static_cast<std::uint32_t>(
      std::max<std::uint64_t>(1, static_cast<std::uint64_t>(options_.min_leaf_samples) * count / samples.size()));
  // Purity = sum of n log n over the parts of a child, minus that of the child: the negated entropy.
  std::int64_t best = -static_cast<std::int64_t>(n_log_n_[count]);
  for (const std::uint32_t n : total) best += n_log_n_[n];
  std::optional<SplitNode> found;
  for (std::size_t begin = 0; begin < features_.size(); begin += kBlock) {
    const auto block = std::span(features_).subspan(begin, std::min(kBlock, features_.size() - begin));
    fill_histograms(persons, block);
    const std::uint16_t* bins = histogram_.data();
    for (const Feature& feature : block) {
      std::array<std::uint32_t, kParts> left{};
      std::uint32_t left_count = 0;
      for (int bin = 1; bin < kBins; ++bin, bins += kParts) {
        std::int64_t purity = 0;
        for (std::size_t p = 0; p < present_count; ++p) {
          const std::size_t part = present[p];
          left[part] += bins[part];
          left_count += bins[part];
          purity += n_log_n_[left[part]] + n_log_n_[total[part] - left[part]];
        }
        if (left_count < fewest || count - left_count < fewest) continue;
        purity -= std::int64_t{n_log_n_[left_count]} + n_log_n_[count - left_count];
        if (purity <= best) continue;
        best = purity;
        found = feature.node;
        found->threshold_mm = static_cast<std::int16_t>((bin - kHalf) * feature.step_mm);
      }
      bins += kParts;
    }
  }
  return found;
}

}  // namespace armature
