#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "tracker/forest/random.h"
#include "tracker/forest/training_set.h"

namespace armature {

/// Finds the best of many random features for a node: the one that takes most entropy of the parts away, counted in
/// integer histograms (one increment per sample and feature) over 23 thresholds. Owns scratch memory: one a thread.
class SplitSearch {
 public:
  explicit SplitSearch(const TrainerOptions& options);

  /// Nothing if no feature separates these samples. Children of the result are unset.
  [[nodiscard]] std::optional<SplitNode> find(std::span<const TrainingPerson> persons,
                                              std::span<const TrainingSample> samples, TrainingRandom random);

 private:
  struct Feature {
    SplitNode node;
    std::int32_t step_mm = 0;  ///< between thresholds, which lie at (k - 11) * step_mm
  };
  [[nodiscard]] Feature random_feature(TrainingRandom& random) const;
  void fill_histograms(std::span<const TrainingPerson> persons, std::span<const Feature> features);

  TrainerOptions options_;
  std::vector<TrainingSample> chosen_;  // the node's samples, thinned to options.node_samples
  std::vector<Feature> features_;
  std::vector<std::uint16_t> histogram_;  // [feature of a block][bin][32 parts]
  std::vector<std::uint32_t> n_log_n_;    // n log2 n in 4096ths of a bit
};

}  // namespace armature
