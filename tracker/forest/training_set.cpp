#include "tracker/forest/training_set.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "tracker/forest/random.h"

namespace armature {
namespace {

bool is_user(const TrainingImage& image, std::size_t pixel) {
  return image.user[pixel] != 0 && image.depth_mm[pixel] != 0 && image.depth_mm[pixel] <= kMaxPersonDepth_mm;
}

}  // namespace

Eigen::Vector3f TrainingPerson::point(int u, int v) const noexcept {
  const double z =
      depth_mm[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u)] * 0.001;
  return Eigen::Vector3d((u - intrinsics.centre_x_px) * z / intrinsics.focal_x_px,
                         (v - intrinsics.centre_y_px) * z / intrinsics.focal_y_px, z)
      .cast<float>();
}

TrainingPerson cut_out_person(const TrainingImage& image) {
  const int width = image.intrinsics.width;
  const int height = image.intrinsics.height;
  int left = width, top = height, right = 0, bottom = 0;
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      if (!is_user(image, static_cast<std::size_t>(v * width + u))) continue;
      left = std::min(left, u);
      right = std::max(right, u + 1);
      top = std::min(top, v);
      bottom = v + 1;
    }
  }
  TrainingPerson person;
  if (bottom == 0) return person;
  person.width = right - left + 2;
  person.height = bottom - top + 2;
  person.depth_mm.assign(static_cast<std::size_t>(person.width * person.height), kBackgroundDepth_mm);
  for (int v = top; v < bottom; ++v) {
    for (int u = left; u < right; ++u) {
      const auto pixel = static_cast<std::size_t>(v * width + u);
      if (!is_user(image, pixel)) continue;
      person.depth_mm[static_cast<std::size_t>((v - top + 1) * person.width + u - left + 1)] = image.depth_mm[pixel];
    }
  }
  person.intrinsics = image.intrinsics;
  person.intrinsics.width = person.width;
  person.intrinsics.height = person.height;
  person.left = left - 1;
  person.top = top - 1;
  person.intrinsics.centre_x_px -= person.left;
  person.intrinsics.centre_y_px -= person.top;
  person.focal = fixed_focal(image.intrinsics.focal_x_px, image.intrinsics.focal_y_px);
  person.joints = image.joints;
  return person;
}

void draw_samples(const TrainingImage& image, const TrainingPerson& person, std::uint32_t person_index, int count,
                  std::uint64_t seed, std::vector<TrainingSample>& out) {
  std::vector<TrainingSample> all;
  for (int v = 1; v + 1 < person.height; ++v) {
    for (int u = 1; u + 1 < person.width; ++u) {
      const auto pixel = static_cast<std::size_t>((v + person.top) * image.intrinsics.width + u + person.left);
      if (!is_user(image, pixel) || image.part_of_pixel[pixel] >= kPartCount) continue;
      all.push_back({.person = person_index,
                     .u = static_cast<std::uint16_t>(u),
                     .v = static_cast<std::uint16_t>(v),
                     .part = image.part_of_pixel[pixel]});
    }
  }
  TrainingRandom random(seed);
  const std::size_t wanted = std::min(all.size(), static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < wanted; ++i) {
    std::swap(all[i], all[i + random.below(static_cast<std::uint32_t>(all.size() - i))]);
  }
  all.resize(wanted);
  std::sort(all.begin(), all.end(),
            [](const TrainingSample& a, const TrainingSample& b) { return std::pair(a.v, a.u) < std::pair(b.v, b.u); });
  out.insert(out.end(), all.begin(), all.end());
}

std::int64_t total(const PartCounts& parts) noexcept {
  return std::accumulate(parts.begin(), parts.end(), std::int64_t{0});
}

PartCounts count_parts(std::span<const TrainingSample> samples) noexcept {
  PartCounts parts{};
  for (const TrainingSample& sample : samples) ++parts[sample.part];
  return parts;
}

std::span<const TrainingSample> draw_of_node(std::span<const TrainingSample> samples, std::int64_t total,
                                             std::int64_t wanted, std::uint64_t seed, const Ranks& ranks,
                                             std::vector<TrainingSample>& scratch) {
  if (total <= wanted) return samples;
  // A uniform number below the limit has the probability wanted / total.
  const std::uint64_t limit =
      ~std::uint64_t{0} / static_cast<std::uint64_t>(total) * static_cast<std::uint64_t>(wanted);
  const auto count = static_cast<std::uint64_t>(ranks.count());
  const auto rank = static_cast<std::uint64_t>(ranks.rank());
  scratch.clear();
  for (const TrainingSample& sample : samples) {
    const std::uint64_t image = sample.person * count + rank;
    const std::uint64_t pixel = image << 32U | std::uint64_t{sample.v} << 16U | sample.u;
    if (derive_seed(seed, pixel) < limit) scratch.push_back(sample);
  }
  return scratch;
}

}  // namespace armature
