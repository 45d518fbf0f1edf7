#include "tracker/forest/tree_training.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace armature {
namespace {

/// Below this depth each node's subtree is one piece of work.
constexpr int kTopDepth = 7;

/// Moves a subtree's indices behind what `tree` holds already and hangs it there; returns its root.
std::int32_t append_subtree(Tree& tree, const Tree& subtree) {
  const auto nodes = static_cast<std::int32_t>(tree.nodes.size());
  const auto leaves = static_cast<std::int32_t>(tree.leaves.size());
  for (SplitNode node : subtree.nodes) {
    for (std::int32_t& child : node.child) child += child >= 0 ? nodes : -leaves;
    tree.nodes.push_back(node);
  }
  tree.leaves.insert(tree.leaves.end(), subtree.leaves.begin(), subtree.leaves.end());
  return subtree.nodes.empty() ? ~leaves : nodes;
}

}  // namespace

TreeTraining::TreeTraining(const TrainerOptions& options, std::span<const TrainingPerson> persons,
                           std::vector<TrainingSample> samples, std::uint32_t tree, int threads, Ranks& ranks)
    : samples_(std::move(samples)), tree_index_(tree), threads_(threads), ranks_(ranks) {
  for (int thread = 0; thread < threads; ++thread) {
    growers_.emplace_back(options, persons, derive_seed(options.seed, 1'000'000'000ULL + tree), ranks);
  }
}

Expected<std::optional<Tree>> TreeTraining::run(SharedCheckpoint& checkpoint, TrainingProgress& progress, double share,
                                                const std::stop_token& stop) {
  GrowingNode root{samples_, 1, 0, count_parts(samples_)};
  ranks_.sum(root.parts);
  const std::int64_t all = total(root.parts);
  if (all == 0) return fail("training: no image shows a pixel of a person");
  grow_top(root, stop);
  if (stopped(stop)) return std::nullopt;

  std::vector<Tree> subtrees(open_.size());
  // The largest first, so that no thread is left with one at the end.
  std::vector<std::size_t> order(open_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return total(open_[a].node.parts) > total(open_[b].node.parts);
  });
  std::mutex mutex;
  for_each_in_parallel(
      order.size(), threads_, [&] { return stopped(stop); },
      [&](std::size_t i, std::size_t thread) {
        const GrowingNode& node = open_[order[i]].node;
        Tree& subtree = subtrees[order[i]];
        const SubtreeId id{tree_index_, static_cast<std::uint32_t>(node.path)};
        if (auto finished = checkpoint.finished(id)) {
          subtree = std::move(*finished);
        } else {
          subtree = growers_[thread].grow(node, stop);
          if (subtree.leaves.empty()) return;  // stopped
          const std::lock_guard lock(mutex);
          checkpoint.append(id, subtree);
        }
        progress.add(share * static_cast<double>(total(node.parts)) / static_cast<double>(all));
      });
  if (stopped(stop)) return std::nullopt;
  if (const auto written = checkpoint.status(); !written) return tl::unexpected(written.error());
  for (std::size_t i = 0; i < open_.size(); ++i) {
    const std::int32_t subtree = append_subtree(tree_, subtrees[i]);
    if (open_[i].parent) tree_.nodes[*open_[i].parent].child[open_[i].side] = subtree;
  }
  return std::move(tree_);
}

void TreeTraining::grow_top(const GrowingNode& root, const std::stop_token& stop) {
  open_ = {{root, {}, 0}};
  for (int depth = 0; depth < kTopDepth; ++depth) {
    std::vector<std::optional<GrownSplit>> splits(open_.size());
    for_each_in_parallel(
        open_.size(), threads_, [&] { return stopped(stop); },
        [&](std::size_t i, std::size_t thread) {
          if (open_[i].node.depth == depth) splits[i] = growers_[thread].split({&open_[i].node, 1})[0];
        });
    std::vector<Open> next;
    for (std::size_t i = 0; i < open_.size(); ++i) {
      if (!splits[i]) {
        next.push_back(open_[i]);  // a leaf: its subtree is that leaf
        continue;
      }
      const std::size_t self = tree_.nodes.size();
      if (open_[i].parent) tree_.nodes[*open_[i].parent].child[open_[i].side] = static_cast<std::int32_t>(self);
      tree_.nodes.push_back(splits[i]->node);
      for (std::size_t side = 0; side < 2; ++side) next.push_back({splits[i]->children[side], self, side});
    }
    open_ = std::move(next);
  }
}

}  // namespace armature
