#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tracker/forest/training_set.h"

namespace armature {

/// A feature on trial, with its 23 thresholds: step_mm apart, the middle one at zero.
struct CandidateFeature {
  SplitNode node;            ///< probes only
  std::int32_t step_mm = 3;  ///< 3 to 66
  std::uint32_t number = 0;  ///< in the order in which the node drew its features
};

/// Tells in which of the 24 bins between its thresholds each feature of a node puts a sample: all features of one
/// sample at once, so that its image is walked while it is in the cache. Integers only, the same on every machine.
class FeatureBins {
 public:
  static constexpr int kBins = 24;
  static constexpr int kHalf = kBins / 2;

  /// Takes the features in an order of its own, that of features(): those with one probe last.
  void assign(std::span<const CandidateFeature> features);
  [[nodiscard]] std::span<const CandidateFeature> features() const noexcept { return features_; }
  /// Numbers in a row of find(): features().size(), rounded up.
  [[nodiscard]] std::size_t stride() const noexcept { return u_x_.size(); }

  /// rows[i][f] = bin * scale + offset_of_part[part of samples[i]] for each of features(). A row is stride() long;
  /// 24 * scale must be below 65536.
  void find(std::span<const TrainingPerson> persons, std::span<const TrainingSample> samples, std::uint16_t scale,
            std::span<const std::uint16_t> offset_of_part, std::uint16_t* rows);

 private:
  std::vector<CandidateFeature> features_;
  // A column for each of them, padded to whole blocks; second probes of those that have one.
  std::vector<std::int16_t> u_x_, u_y_, v_x_, v_y_;
  std::vector<std::int16_t> middle_, last_;
  std::vector<std::uint16_t> reciprocal_;
  std::vector<std::uint32_t> addresses_;  // scratch of find()
  std::size_t two_probes_ = 0;            // columns before this one need their second probe
};

}  // namespace armature
