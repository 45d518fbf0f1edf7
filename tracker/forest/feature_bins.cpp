#include "tracker/forest/feature_bins.h"

#include <algorithm>
#include <array>

namespace armature {
namespace {

constexpr std::size_t kBlock = 32;

std::size_t whole_blocks(std::size_t count) {
  return (count + kBlock - 1) / kBlock * kBlock;
}

struct ProbeOrigin {
  PersonImage image;
  ProbeScale scale;
  std::int32_t u, v;
};

using Depths = std::array<std::uint16_t, kBlock>;

/// Where probe() looks, for a block of features. What falls on the frame or beyond reads the first pixel, which is
/// background too and always in the cache.
[[gnu::always_inline]] inline void find_addresses(const ProbeOrigin& at, const std::int16_t* x_mm,
                                                  const std::int16_t* y_mm, std::uint32_t* address) {
  const std::int32_t width = at.image.width;
  const auto columns = static_cast<std::uint32_t>(width - 1);
  const auto rows = static_cast<std::uint32_t>(at.image.height - 1);
  for (std::size_t i = 0; i < kBlock; ++i) {
    const std::int32_t x = at.u + ((x_mm[i] * at.scale.x + 32768) >> 16);
    const std::int32_t y = at.v + ((y_mm[i] * at.scale.y + 32768) >> 16);
    const bool inside = static_cast<std::uint32_t>(x) < columns && static_cast<std::uint32_t>(y) < rows;
    address[i] = inside ? static_cast<std::uint32_t>(y * width + x) : 0;
  }
  for (std::size_t i = 0; i < kBlock; ++i) __builtin_prefetch(at.image.depth_mm + address[i]);
}

[[gnu::always_inline]] inline void read_depths(const std::uint16_t* depth_mm, const std::uint32_t* address,
                                               Depths& depths) {
#pragma GCC unroll 8
  for (std::size_t i = 0; i < kBlock; ++i) depths[i] = depth_mm[address[i]];
}

struct BinTable {
  const std::int16_t* middle;
  const std::int16_t* last;
  const std::uint16_t* reciprocal;
};

[[gnu::always_inline]] inline void bin_block(const Depths& u, const Depths& v, const BinTable& table,
                                             std::uint16_t scale, std::uint16_t offset, std::uint16_t* row) {
  for (std::size_t i = 0; i < kBlock; ++i) {
    const auto feature_mm = static_cast<std::int16_t>(u[i] - v[i]);
    auto shifted = static_cast<std::int16_t>(feature_mm + table.middle[i]);
    shifted = std::max<std::int16_t>(shifted, 0);
    shifted = std::min(shifted, table.last[i]);
    const auto twice = static_cast<std::uint16_t>(shifted << 1);
    const auto high = static_cast<std::uint16_t>((std::uint32_t{twice} * table.reciprocal[i]) >> 16U);
    const auto bin = static_cast<std::uint16_t>(high >> 2U);
    row[i] = static_cast<std::uint16_t>(bin * scale + offset);
  }
}

/// The columns of a FeatureBins, and where the result goes.
struct Columns {
  std::size_t two_probes, count;  // whole blocks
  const std::int16_t *u_x, *u_y, *v_x, *v_y;
  BinTable table;
};

struct Output {
  std::uint16_t scale;
  std::span<const std::uint16_t> offset_of_part;
  std::uint16_t* rows;
};

[[gnu::always_inline]] inline ProbeOrigin origin_of(std::span<const TrainingPerson> persons,
                                                    const TrainingSample& sample) {
  const TrainingPerson& person = persons[sample.person];
  const PersonImage image = person.image();
  const std::uint16_t depth_mm = image.depth_mm[sample.v * image.width + sample.u];
  return {image, probe_scale(person.focal, depth_mm), sample.u, sample.v};
}

[[gnu::always_inline]] inline void prefetch_origin(std::span<const TrainingPerson> persons,
                                                   const TrainingSample& sample) {
  const PersonImage image = persons[sample.person].image();
  __builtin_prefetch(image.depth_mm + sample.v * image.width + sample.u);
}

[[gnu::always_inline]] inline void find_all_addresses(const ProbeOrigin& at, const Columns& c, std::uint32_t* address) {
  for (std::size_t begin = 0; begin < c.count; begin += kBlock) {
    find_addresses(at, c.u_x + begin, c.u_y + begin, address + begin);
    if (begin < c.two_probes) find_addresses(at, c.v_x + begin, c.v_y + begin, address + c.count + begin);
  }
}

[[gnu::always_inline]] inline void find_bins(std::span<const TrainingPerson> persons,
                                             std::span<const TrainingSample> samples, const Columns& c,
                                             const Output& out, std::uint32_t* addresses) {
  std::uint32_t* now = addresses;
  std::uint32_t* then = addresses + 2 * c.count;
  ProbeOrigin next = origin_of(persons, samples[0]);
  find_all_addresses(next, c, then);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    std::swap(now, then);
    const ProbeOrigin at = next;
    if (i + 3 < samples.size()) __builtin_prefetch(&persons[samples[i + 3].person]);
    if (i + 2 < samples.size()) prefetch_origin(persons, samples[i + 2]);
    // The next sample's image is on its way from memory while this one's is looked at.
    if (i + 1 < samples.size()) {
      next = origin_of(persons, samples[i + 1]);
      find_all_addresses(next, c, then);
    }
    const std::uint16_t offset = out.offset_of_part[samples[i].part];
    std::uint16_t* const row = out.rows + i * c.count;
    Depths u, v;
    for (std::size_t begin = 0; begin < c.count; begin += kBlock) {
      read_depths(at.image.depth_mm, now + begin, u);
      if (begin < c.two_probes) {
        read_depths(at.image.depth_mm, now + c.count + begin, v);
      } else if (begin == c.two_probes) {
        v.fill(at.image.depth_mm[at.v * at.image.width + at.u]);
      }
      const BinTable table{c.table.middle + begin, c.table.last + begin, c.table.reciprocal + begin};
      bin_block(u, v, table, out.scale, offset, row + begin);
    }
  }
}

// Integers only: wider registers change nothing about the result.
void find_bins_plain(std::span<const TrainingPerson> persons, std::span<const TrainingSample> samples,
                     const Columns& columns, const Output& out, std::uint32_t* addresses) {
  find_bins(persons, samples, columns, out, addresses);
}
#if defined(__x86_64__)
[[gnu::target("avx2")]] void find_bins_avx2(std::span<const TrainingPerson> persons,
                                            std::span<const TrainingSample> samples, const Columns& columns,
                                            const Output& out, std::uint32_t* addresses) {
  find_bins(persons, samples, columns, out, addresses);
}
bool has_avx2() {
  return __builtin_cpu_supports("avx2") != 0;
}
#else
constexpr auto find_bins_avx2 = find_bins_plain;
bool has_avx2() {
  return false;
}
#endif

}  // namespace

void FeatureBins::assign(std::span<const CandidateFeature> features) {
  features_.assign(features.begin(), features.end());
  const auto one_probe = std::stable_partition(features_.begin(), features_.end(), [](const CandidateFeature& feature) {
    return feature.node.v_mm != std::array<std::int16_t, 2>{};
  });
  // A block of both kinds counts as of two.
  two_probes_ = whole_blocks(static_cast<std::size_t>(one_probe - features_.begin()));
  const std::size_t padded = whole_blocks(features_.size());
  for (auto* column : {&u_x_, &u_y_, &v_x_, &v_y_}) column->assign(padded, 0);
  for (auto* column : {&middle_, &last_}) column->assign(padded, 0);
  reciprocal_.assign(padded, 0);
  for (std::size_t i = 0; i < features_.size(); ++i) {
    const auto& [node, step_mm, number] = features_[i];
    u_x_[i] = node.u_mm[0];
    u_y_[i] = node.u_mm[1];
    v_x_[i] = node.v_mm[0];
    v_y_[i] = node.v_mm[1];
    middle_[i] = static_cast<std::int16_t>(kHalf * step_mm);
    last_[i] = static_cast<std::int16_t>(kBins * step_mm - 1);
    reciprocal_[i] = static_cast<std::uint16_t>((1 << 17) / step_mm + 1);
  }
}

void FeatureBins::find(std::span<const TrainingPerson> persons, std::span<const TrainingSample> samples,
                       std::uint16_t scale, std::span<const std::uint16_t> offset_of_part, std::uint16_t* rows) {
  static const auto find_bins_here = has_avx2() ? find_bins_avx2 : find_bins_plain;
  if (samples.empty()) return;
  addresses_.resize(4 * stride());
  find_bins_here(persons, samples,
                 {two_probes_,
                  stride(),
                  u_x_.data(),
                  u_y_.data(),
                  v_x_.data(),
                  v_y_.data(),
                  {middle_.data(), last_.data(), reciprocal_.data()}},
                 {scale, offset_of_part, rows}, addresses_.data());
}

}  // namespace armature
