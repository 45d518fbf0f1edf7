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

/// One of the two probes of a block of features, ready for vector registers.
struct ProbeBlock {
  std::array<std::int32_t, kBlock> x_mm, y_mm;
  std::array<std::int32_t, kBlock> address;  // in the image
};

/// The thresholds of a block of features, and in which bin a sample falls.
struct BinBlock {
  std::array<std::int32_t, kBlock> half_range_mm, last_mm, reciprocal;
  std::array<std::int32_t, kBlock> feature_mm;
  std::array<std::int32_t, kBlock> slot;  // in the histograms, of the part 0
};

struct ProbeOrigin {
  ProbeScale scale;
  std::int32_t u, v;
  std::int32_t right, bottom, width;  // the last column and row, and the columns
};

// The loops of fill_histograms() without its loads and stores, so that they run in vector registers. Integers only:
// wider registers change nothing about the result.

/// The same as probe() but for the load.
[[gnu::always_inline]] inline void find_addresses(const ProbeOrigin& at, ProbeBlock& block) {
  for (std::size_t i = 0; i < kBlock; ++i) {
    const std::int32_t x = std::clamp(at.u + ((block.x_mm[i] * at.scale.x + 32768) >> 16), 0, at.right);
    const std::int32_t y = std::clamp(at.v + ((block.y_mm[i] * at.scale.y + 32768) >> 16), 0, at.bottom);
    block.address[i] = y * at.width + x;
  }
}
[[gnu::always_inline]] inline void find_slots(BinBlock& block) {
  for (std::size_t i = 0; i < kBlock; ++i) {
    const std::int32_t shifted = std::clamp(block.feature_mm[i] + block.half_range_mm[i], 0, block.last_mm[i]);
    const std::int32_t bin = (shifted * block.reciprocal[i]) >> kReciprocalBits;
    block.slot[i] = (static_cast<std::int32_t>(i) * kBins + bin) * static_cast<std::int32_t>(kParts);
  }
}

void find_addresses_plain(const ProbeOrigin& at, ProbeBlock& block) {
  find_addresses(at, block);
}
void find_slots_plain(BinBlock& block) {
  find_slots(block);
}
#if defined(__x86_64__)
[[gnu::target("avx2")]] void find_addresses_avx2(const ProbeOrigin& at, ProbeBlock& block) {
  find_addresses(at, block);
}
[[gnu::target("avx2")]] void find_slots_avx2(BinBlock& block) {
  find_slots(block);
}
bool has_avx2() {
  return __builtin_cpu_supports("avx2") != 0;
}
#else
constexpr auto find_addresses_avx2 = find_addresses_plain;
constexpr auto find_slots_avx2 = find_slots_plain;
bool has_avx2() {
  return false;
}
#endif

std::span<const TrainingSample> thin(std::span<const TrainingSample> samples, std::size_t most,
                                     std::vector<TrainingSample>& scratch) {
  if (samples.size() <= most) return samples;
  scratch.resize(most);
  for (std::size_t i = 0; i < most; ++i) scratch[i] = samples[i * samples.size() / most];
  return scratch;
}

}  // namespace

SplitSearch::SplitSearch(const TrainerOptions& options) : options_(options) {
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
  return feature;
}

void SplitSearch::fill_histograms(std::span<const TrainingPerson> persons, std::span<const Feature> features) {
  std::fill_n(histogram_.begin(), features.size() * kBins * kParts, std::uint16_t{0});
  const auto addresses = has_avx2() ? find_addresses_avx2 : find_addresses_plain;
  const auto slots = has_avx2() ? find_slots_avx2 : find_slots_plain;
  ProbeBlock u{}, v{};
  BinBlock bins{};
  for (std::size_t i = 0; i < features.size(); ++i) {
    u.x_mm[i] = features[i].node.u_mm[0];
    u.y_mm[i] = features[i].node.u_mm[1];
    v.x_mm[i] = features[i].node.v_mm[0];
    v.y_mm[i] = features[i].node.v_mm[1];
    bins.half_range_mm[i] = kHalf * features[i].step_mm;
    bins.last_mm[i] = kBins * features[i].step_mm - 1;
    bins.reciprocal[i] = (1 << kReciprocalBits) / features[i].step_mm + 1;
  }
  for (const TrainingSample& sample : chosen_) {
    const TrainingPerson& person = persons[sample.person];
    const PersonImage image = person.image();
    const ProbeScale scale = probe_scale(person.focal, image.depth_mm[sample.v * image.width + sample.u]);
    const ProbeOrigin origin{scale, sample.u, sample.v, image.width - 1, image.height - 1, image.width};
    addresses(origin, u);
    addresses(origin, v);
    for (std::size_t i = 0; i < kBlock; ++i) {
      bins.feature_mm[i] = image.depth_mm[u.address[i]] - image.depth_mm[v.address[i]];
    }
    slots(bins);
    std::uint16_t* histogram = histogram_.data() + sample.part;
    for (std::size_t i = 0; i < features.size(); ++i) ++histogram[bins.slot[i]];
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
