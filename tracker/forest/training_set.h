#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "tracker/forest/part_feature.h"
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
  std::uint32_t person = 0;
  std::uint16_t u = 0, v = 0;  ///< in the cut-out
  std::uint8_t part = 0;
};

/// Cuts the user out of an image, as PartClassifier will do: pixels of the user that have a depth.
[[nodiscard]] TrainingPerson cut_out_person(const TrainingImage& image);

/// Draws at most `count` different pixels that have a part, in the order of the image.
void draw_samples(const TrainingImage& image, const TrainingPerson& person, std::uint32_t person_index, int count,
                  std::uint64_t seed, std::vector<TrainingSample>& out);

}  // namespace armature
