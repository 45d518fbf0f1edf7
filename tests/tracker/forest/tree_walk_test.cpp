#include "tracker/forest/tree_walk.h"

#include <gtest/gtest.h>

#include "tracker/forest/random.h"

namespace armature {
namespace {

/// A tree of random decisions, some paths short and some long.
Tree random_tree(int nodes, TrainingRandom random) {
  Tree tree;
  struct End {
    std::size_t node, side;
  };
  std::vector<End> open;
  const auto probe = [&] { return static_cast<std::int16_t>(random.between(-kMaxProbe_mm, kMaxProbe_mm)); };
  for (int i = 0; i < nodes; ++i) {
    if (i > 0) {
      const auto pick = static_cast<std::size_t>(random.between(0, static_cast<int>(open.size()) - 1));
      tree.nodes[open[pick].node].child[open[pick].side] = i;
      open.erase(open.begin() + static_cast<std::ptrdiff_t>(pick));
    }
    tree.nodes.push_back({.u_mm = {probe(), probe()},
                          .v_mm = {probe(), probe()},
                          .threshold_mm = static_cast<std::int16_t>(random.between(-1500, 1500))});
    open.push_back({tree.nodes.size() - 1, 0});
    open.push_back({tree.nodes.size() - 1, 1});
  }
  for (const End& end : open) {
    tree.nodes[end.node].child[end.side] = ~static_cast<std::int32_t>(tree.leaves.size());
    tree.leaves.emplace_back();
  }
  if (nodes == 0) tree.leaves.emplace_back();
  return tree;
}

std::uint32_t leaf_by_the_book(const Tree& tree, const PersonImage& image, const WalkStart& at) {
  std::int32_t node = tree.nodes.empty() ? ~0 : 0;
  while (node >= 0) {
    const SplitNode& split = tree.nodes[static_cast<std::size_t>(node)];
    node = split.child[part_feature(image, at.u, at.v, at.scale, split) >= split.threshold_mm ? 1 : 0];
  }
  return static_cast<std::uint32_t>(~node);
}

TEST(TreeWalk, EveryPixelEndsInTheLeafToWhichItsDecisionsLead) {
  constexpr int kWidth = 61, kHeight = 47;
  TrainingRandom random(5);
  std::vector<std::uint16_t> depth_mm(static_cast<std::size_t>(kWidth * kHeight), kBackgroundDepth_mm);
  for (std::uint16_t& depth : depth_mm) {
    if (random.below(3) != 0) depth = static_cast<std::uint16_t>(random.between(1, kMaxPersonDepth_mm));
  }
  const PersonImage image{depth_mm.data(), kWidth, kHeight};
  for (const int nodes : {0, 1, 2, 3000}) {
    const Tree tree = random_tree(nodes, TrainingRandom(static_cast<std::uint64_t>(nodes)));
    const TreeWalk walk(tree);
    for (const std::size_t count : {0, 1, 63, 64, 65, 1500}) {
      std::vector<WalkStart> starts(count);
      for (WalkStart& start : starts) {
        start.u = random.between(0, kWidth - 1);
        start.v = random.between(0, kHeight - 1);
        start.scale = probe_scale(fixed_focal(40, 42), depth_mm[static_cast<std::size_t>(start.v * kWidth + start.u)]);
      }
      std::vector<std::uint32_t> leaves(count, 77);
      walk.find_leaves(image, starts, leaves);
      for (std::size_t i = 0; i < count; ++i) {
        EXPECT_EQ(leaves[i], leaf_by_the_book(tree, image, starts[i])) << nodes << " nodes, pixel " << i;
      }
    }
  }
}

}  // namespace
}  // namespace armature
