#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "tracker/forest/part_feature.h"
#include "tracker/forest/ranks.h"
#include "tracker/forest/trainer.h"

namespace armature {

/// A training image reduced to its person.
struct alignas(64) TrainingPerson {
  std::vector<std::uint16_t> depth_mm;  ///< [height][width] as PersonImage has it
  int width = 0;
  int height = 0;
  FixedFocal focal;
  int left = 0, top = 0;  ///< where the cut-out's first pixel stands in the image; -1 where the border sticks out
  Intrinsics intrinsics;  ///< of the cut-out: its centre is relative to the cut-out's first pixel
  std::array<Eigen::Vector3f, kJointCount> joints{};

  [[nodiscard]] PersonImage image() const noexcept { return {depth_mm.data(), width, height}; }
  [[nodiscard]] Eigen::Vector3f point(int u, int v) const noexcept;
};

/// One pixel that a tree learns from.
struct TrainingSample {
  std::uint32_t person = 0;    ///< of those that this rank holds
  std::uint16_t u = 0, v = 0;  ///< in the cut-out
  std::uint8_t part = 0;
};

/// How many samples there are of each part, on all ranks together.
using PartCounts = std::array<std::int64_t, kPartCount>;
[[nodiscard]] std::int64_t total(const PartCounts& parts) noexcept;
/// Of this rank's samples alone.
[[nodiscard]] PartCounts count_parts(std::span<const TrainingSample> samples) noexcept;

/// Samples of one node and its place in the tree. Growing reorders the samples but keeps each child's in the order of
/// the images, so that a node reads its images front to back.
struct GrowingNode {
  std::span<TrainingSample> samples;  ///< this rank's
  std::uint64_t path = 1;             ///< 1 for the root, 2 p and 2 p + 1 for the children of p
  int depth = 0;
  PartCounts parts{};  ///< on all ranks
};

/// Cuts the user out of an image, as PartClassifier will do: pixels of the user that have a depth.
[[nodiscard]] TrainingPerson cut_out_person(const TrainingImage& image);

/// Draws at most `count` different pixels that have a part, in the order of the image.
void draw_samples(const TrainingImage& image, const TrainingPerson& person, std::uint32_t person_index, int count,
                  std::uint64_t seed, std::vector<TrainingSample>& out);

/// Of a node's `total` samples on all ranks about `wanted`, drawn by chance; of this rank's samples those that were
/// drawn. All of them if there are no more than wanted. Whether a sample is drawn depends on the seed, its image and
/// its pixel alone: neither on the other samples and their order nor on who holds it. `scratch` may be what is
/// returned.
[[nodiscard]] std::span<const TrainingSample> draw_of_node(std::span<const TrainingSample> samples, std::int64_t total,
                                                           std::int64_t wanted, std::uint64_t seed, const Ranks& ranks,
                                                           std::vector<TrainingSample>& scratch);

}  // namespace armature
