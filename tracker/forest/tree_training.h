#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include "tracker/forest/shared_checkpoint.h"
#include "tracker/forest/training_threads.h"
#include "tracker/forest/tree_grower.h"

namespace armature {

/// Trains one tree: its first levels breadth-first, then each subtree as one piece of work. Several threads take
/// subtrees in turn; several ranks, of one thread each, go through them together.
class TreeTraining {
 public:
  /// `persons` and `ranks` must outlive it.
  TreeTraining(const TrainerOptions& options, std::span<const TrainingPerson> persons,
               std::vector<TrainingSample> samples, std::uint32_t tree, int threads, Ranks& ranks);

  /// The tree, with `share` added to the progress on the way; nothing after a stop on any rank.
  [[nodiscard]] Expected<std::optional<Tree>> run(SharedCheckpoint& checkpoint, TrainingProgress& progress,
                                                  double share, const std::stop_token& stop);

 private:
  struct Open {
    GrowingNode node;
    std::optional<std::size_t> parent;
    std::size_t side = 0;
  };
  void grow_top(const GrowingNode& root, const std::stop_token& stop);
  [[nodiscard]] bool stopped(const std::stop_token& stop) { return any_rank(ranks_, stop.stop_requested()); }

  std::vector<TrainingSample> samples_;
  std::uint32_t tree_index_;
  int threads_;
  Ranks& ranks_;
  std::vector<TreeGrower> growers_;  // one a thread
  std::vector<Open> open_;
  Tree tree_;
};

}  // namespace armature
