#pragma once

#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "tracker/forest/split_search.h"

namespace armature {

struct GrownSplit {
  SplitNode node;
  std::array<GrowingNode, 2> children;
};

/// Grows nodes of one tree, together with the other ranks. Not thread-safe: one a thread; several may work on disjoint
/// nodes of the same tree if this process is the only rank.
class TreeGrower {
 public:
  /// `ranks` must outlive the grower.
  TreeGrower(const TrainerOptions& options, std::span<const TrainingPerson> persons, std::uint64_t tree_seed,
             Ranks& ranks);

  /// Nothing where a node is to be a leaf. Nodes together cost the ranks less talk than one by one.
  [[nodiscard]] std::vector<std::optional<GrownSplit>> split(std::span<const GrowingNode> nodes);
  /// The whole tree below `node`, nodes before their children, left before right. Cut short when a stop is asked for,
  /// on any rank.
  [[nodiscard]] Tree grow(const GrowingNode& node, const std::stop_token& stop);

 private:
  [[nodiscard]] bool may_split(const GrowingNode& node) const;
  [[nodiscard]] std::vector<std::optional<SplitNode>> search(std::span<const GrowingNode* const> nodes);
  [[nodiscard]] GrownSplit partition(const GrowingNode& node, const SplitNode& split);

  TrainerOptions options_;
  std::span<const TrainingPerson> persons_;
  std::uint64_t tree_seed_;
  Ranks& ranks_;
  SplitSearch search_;
  std::vector<TrainingSample> right_;      // scratch of a partition
  std::vector<std::uint16_t> histograms_;  // of the nodes that are searched together
};

}  // namespace armature
