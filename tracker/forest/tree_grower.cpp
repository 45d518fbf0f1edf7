#include "tracker/forest/tree_grower.h"

#include <algorithm>

#include "tracker/forest/leaf_maker.h"

namespace armature {

TreeGrower::TreeGrower(const TrainerOptions& options, std::span<const TrainingPerson> persons, std::uint64_t tree_seed)
    : options_(options), persons_(persons), tree_seed_(tree_seed), search_(options) {}

std::optional<GrownSplit> TreeGrower::split(const GrowingNode& node) {
  if (node.depth >= options_.max_depth) return {};
  if (node.samples.size() < 2 * static_cast<std::size_t>(options_.min_leaf_samples)) return {};
  const auto found = search_.find(persons_, node.samples, TrainingRandom(derive_seed(tree_seed_, node.path)));
  if (!found) return {};

  right_.clear();
  auto left_end = node.samples.begin();
  for (const TrainingSample& sample : node.samples) {
    const TrainingPerson& person = persons_[sample.person];
    const PersonImage image = person.image();
    const ProbeScale scale = probe_scale(person.focal, image.depth_mm[sample.v * image.width + sample.u]);
    if (part_feature(image, sample.u, sample.v, scale, *found) < found->threshold_mm) {
      *left_end++ = sample;
    } else {
      right_.push_back(sample);
    }
  }
  const auto left_size = static_cast<std::size_t>(left_end - node.samples.begin());
  std::copy(right_.begin(), right_.end(), left_end);
  return GrownSplit{*found,
                    {GrowingNode{node.samples.first(left_size), 2 * node.path, node.depth + 1},
                     GrowingNode{node.samples.subspan(left_size), 2 * node.path + 1, node.depth + 1}}};
}

Tree TreeGrower::grow(const GrowingNode& root, const std::stop_token& stop) {
  struct Open {
    GrowingNode node;
    std::size_t parent;
    std::size_t side;
  };
  constexpr std::size_t kNoParent = ~std::size_t{0};
  Tree tree;
  std::vector<Open> open = {{root, kNoParent, 0}};
  while (!open.empty() && !stop.stop_requested()) {
    const Open next = open.back();
    open.pop_back();
    std::int32_t self = 0;
    if (const auto split_here = split(next.node)) {
      self = static_cast<std::int32_t>(tree.nodes.size());
      tree.nodes.push_back(split_here->node);
      open.push_back({split_here->children[1], tree.nodes.size() - 1, 1});
      open.push_back({split_here->children[0], tree.nodes.size() - 1, 0});
    } else {
      self = ~static_cast<std::int32_t>(tree.leaves.size());
      tree.leaves.push_back(make_leaf(persons_, next.node.samples));
    }
    if (next.parent != kNoParent) tree.nodes[next.parent].child[next.side] = self;
  }
  return tree;
}

}  // namespace armature
