#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "tracker/forest/feature_bins.h"
#include "tracker/forest/random.h"
#include "tracker/forest/training_set.h"

namespace armature {

/// A node whose split is searched for, as all ranks know it.
struct SearchedNode {
  PartCounts parts{};        ///< of the samples that the search looks at
  std::int64_t samples = 0;  ///< of the whole node
  std::uint64_t seed = 0;    ///< of its features
};

/// Finds the best of many random features for a node: the one that takes most entropy of the parts away, counted in
/// integer histograms (one increment per sample and feature) over 23 thresholds. Histograms of several ranks add up.
/// Owns scratch memory: one a thread.
class SplitSearch {
 public:
  explicit SplitSearch(const TrainerOptions& options);

  /// Numbers in the histograms of a node's features.
  [[nodiscard]] std::size_t histogram_size(const SearchedNode& node) const noexcept;
  /// Counts these samples into the node's histograms, [feature][bin][part that occurs], of histogram_size().
  void count(std::span<const TrainingPerson> persons, std::span<const TrainingSample> samples, const SearchedNode& node,
             std::span<std::uint16_t> histograms);
  /// The best split by the histograms of all its samples. Nothing if no feature separates them. Children are unset.
  [[nodiscard]] std::optional<SplitNode> best(const SearchedNode& node, std::span<const std::uint16_t> histograms);

 private:
  void draw_features(std::uint64_t seed);
  [[nodiscard]] std::uint32_t n_log_n(std::int64_t n) const { return n_log_n_[static_cast<std::size_t>(n)]; }

  TrainerOptions options_;
  std::optional<std::uint64_t> drawn_seed_;
  std::vector<CandidateFeature> drawn_;
  FeatureBins bins_;
  std::vector<std::uint16_t> rows_;     // [sample of a chunk][feature]: where its histogram counts the sample
  std::vector<std::uint32_t> n_log_n_;  // n log2 n in 4096ths of a bit
};

}  // namespace armature
