#pragma once

#include <span>
#include <stop_token>
#include <vector>

#include "tracker/forest/split_search.h"

namespace armature {

/// Samples of one node and its place in the tree. Growing reorders the samples but keeps each child's in the order of
/// the images, so that a node reads its images front to back.
struct GrowingNode {
  std::span<TrainingSample> samples;
  std::uint64_t path = 1;  ///< 1 for the root, 2 p and 2 p + 1 for the children of p
  int depth = 0;
};

struct GrownSplit {
  SplitNode node;
  std::array<GrowingNode, 2> children;
};

/// Grows nodes of one tree. Not thread-safe: one a thread; several may work on disjoint nodes of the same tree.
class TreeGrower {
 public:
  TreeGrower(const TrainerOptions& options, std::span<const TrainingPerson> persons, std::uint64_t tree_seed);

  /// Nothing where the node is to be a leaf.
  [[nodiscard]] std::optional<GrownSplit> split(const GrowingNode& node);
  /// The whole tree below `node`, depth-first, nodes before their children. Cut short when a stop is asked for.
  [[nodiscard]] Tree grow(const GrowingNode& node, const std::stop_token& stop);

 private:
  TrainerOptions options_;
  std::span<const TrainingPerson> persons_;
  std::uint64_t tree_seed_;
  SplitSearch search_;
  std::vector<TrainingSample> right_;  // scratch of a partition
};

}  // namespace armature
