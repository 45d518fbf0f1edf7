#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "tracker/forest/feature_bins.h"
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
  void draw_features(TrainingRandom random);
  void fill_histograms(std::span<const TrainingPerson> persons, std::span<const TrainingSample> samples,
                       std::span<const std::uint16_t> column_of_part);

  TrainerOptions options_;
  std::vector<TrainingSample> thinned_;  // scratch of find()
  std::vector<CandidateFeature> drawn_;
  FeatureBins bins_;
  std::vector<std::uint16_t> rows_;       // [sample of a chunk][feature]: where its histogram counts the sample
  std::vector<std::uint16_t> histogram_;  // [feature][bin][part that occurs here]
  std::size_t columns_ = 0;               // parts that occur here, padded
  std::vector<std::uint32_t> n_log_n_;    // n log2 n in 4096ths of a bit
};

}  // namespace armature
