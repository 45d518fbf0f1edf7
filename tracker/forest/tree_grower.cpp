#include "tracker/forest/tree_grower.h"

#include <algorithm>

#include "tracker/forest/leaf_maker.h"
#include "tracker/forest/random.h"

namespace armature {
namespace {

/// Nodes that a rank scores of those that are searched together, at most, and the memory for their histograms.
constexpr std::size_t kNodesOfARank = 16;
constexpr std::size_t kHistogramBytes = std::size_t{128} << 20U;
/// Samples ahead of their turn at which a partition asks for them from memory.
constexpr std::size_t kAhead = 16;

std::size_t nodes_at_once(const TrainerOptions& options, const Ranks& ranks) {
  if (ranks.count() == 1) return 1;  // whose histograms stay in the cache
  const std::size_t bytes = static_cast<std::size_t>(options.features_per_node) * FeatureBins::kBins * 32 * 2;
  return std::clamp<std::size_t>(kHistogramBytes / bytes, 1, kNodesOfARank * static_cast<std::size_t>(ranks.count()));
}

/// Numbers nodes and leaves from the left, each node before those below it.
Tree from_the_left(const Tree& tree) {
  if (tree.nodes.empty()) return tree;
  struct Open {
    std::int32_t child;
    std::int32_t* link;
  };
  Tree result;
  result.nodes.reserve(tree.nodes.size());  // links stay where they are
  std::int32_t root = 0;
  std::vector<Open> open = {{0, &root}};
  while (!open.empty()) {
    const auto [child, link] = open.back();
    open.pop_back();
    if (child < 0) {
      *link = ~static_cast<std::int32_t>(result.leaves.size());
      result.leaves.push_back(tree.leaves[static_cast<std::size_t>(~child)]);
      continue;
    }
    *link = static_cast<std::int32_t>(result.nodes.size());
    SplitNode& node = result.nodes.emplace_back(tree.nodes[static_cast<std::size_t>(child)]);
    for (const std::size_t side : {1U, 0U}) open.push_back({node.child[side], &node.child[side]});
  }
  return result;
}

}  // namespace

TreeGrower::TreeGrower(const TrainerOptions& options, std::span<const TrainingPerson> persons, std::uint64_t tree_seed,
                       Ranks& ranks)
    : options_(options), persons_(persons), tree_seed_(tree_seed), ranks_(ranks), search_(options) {}

bool TreeGrower::may_split(const GrowingNode& node) const {
  return node.depth < options_.max_depth && total(node.parts) >= 2 * std::int64_t{options_.min_leaf_samples} &&
         std::count(node.parts.begin(), node.parts.end(), 0) + 1 < std::ssize(node.parts);
}

std::vector<std::optional<SplitNode>> TreeGrower::search(std::span<const GrowingNode* const> nodes) {
  const std::size_t count = nodes.size();
  std::vector<SearchedNode> searched(count);
  std::vector<std::vector<TrainingSample>> scratch(count);
  std::vector<std::span<const TrainingSample>> looked_at(count);
  bool thinned = false;
  std::vector<std::int64_t> sums(count * kPartCount);
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t samples = total(nodes[i]->parts);
    searched[i] = {nodes[i]->parts, samples, derive_seed(tree_seed_, nodes[i]->path)};
    looked_at[i] =
        draw_of_node(nodes[i]->samples, samples, options_.node_samples, searched[i].seed, ranks_, scratch[i]);
    if (samples <= options_.node_samples) continue;
    thinned = true;
    std::ranges::copy(count_parts(looked_at[i]), sums.begin() + static_cast<std::ptrdiff_t>(i * kPartCount));
  }
  if (thinned) ranks_.sum(sums);
  for (std::size_t i = 0; i < count; ++i) {
    if (searched[i].samples <= options_.node_samples) continue;
    std::copy_n(sums.begin() + static_cast<std::ptrdiff_t>(i * kPartCount), kPartCount, searched[i].parts.begin());
  }

  // Each rank counts its samples of every node, and scores an equal share of the nodes by the sums.
  const auto ranks = static_cast<std::size_t>(ranks_.count());
  const auto first_of = [&](std::size_t rank) { return rank * count / ranks; };
  std::vector<std::size_t> begin_of(count + 1, 0);
  for (std::size_t i = 0; i < count; ++i) begin_of[i + 1] = begin_of[i] + search_.histogram_size(searched[i]);
  histograms_.resize(std::max(histograms_.size(), begin_of[count]));
  const auto histograms = std::span(histograms_).first(begin_of[count]);
  for (std::size_t i = 0; i < count; ++i) {
    search_.count(persons_, looked_at[i], searched[i], histograms.subspan(begin_of[i], begin_of[i + 1] - begin_of[i]));
  }
  std::vector<std::size_t> lengths(ranks);
  for (std::size_t r = 0; r < ranks; ++r) lengths[r] = begin_of[first_of(r + 1)] - begin_of[first_of(r)];
  ranks_.sum_apart(histograms, lengths);

  // All but one rank add zeros to what that one found.
  constexpr std::size_t kNumbers = 6;
  std::vector<std::int64_t> found(count * kNumbers, 0);
  const auto mine = static_cast<std::size_t>(ranks_.rank());
  for (std::size_t i = first_of(mine); i < first_of(mine + 1); ++i) {
    const auto begin = begin_of[i] - begin_of[first_of(mine)];
    const auto best = search_.best(searched[i], histograms.subspan(begin, begin_of[i + 1] - begin_of[i]));
    if (!best) continue;
    const auto& [u, v, child, threshold] = *best;
    std::ranges::copy(std::array<std::int64_t, kNumbers>{1, u[0], u[1], v[0], v[1], threshold},
                      found.begin() + static_cast<std::ptrdiff_t>(i * kNumbers));
  }
  ranks_.sum(found);
  std::vector<std::optional<SplitNode>> splits(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto number = [&](std::size_t k) { return static_cast<std::int16_t>(found[i * kNumbers + k]); };
    if (number(0) != 0) splits[i] = SplitNode{{number(1), number(2)}, {number(3), number(4)}, {}, number(5)};
  }
  return splits;
}

GrownSplit TreeGrower::partition(const GrowingNode& node, const SplitNode& split) {
  right_.clear();
  auto left_end = node.samples.begin();
  for (std::size_t i = 0; i < node.samples.size(); ++i) {
    if (i + kAhead < node.samples.size()) __builtin_prefetch(&persons_[node.samples[i + kAhead].person]);
    if (i + kAhead / 2 < node.samples.size()) {
      const TrainingSample& soon = node.samples[i + kAhead / 2];
      const PersonImage image = persons_[soon.person].image();
      __builtin_prefetch(image.depth_mm + soon.v * image.width + soon.u);
    }
    const TrainingSample sample = node.samples[i];
    const TrainingPerson& person = persons_[sample.person];
    const PersonImage image = person.image();
    const ProbeScale scale = probe_scale(person.focal, image.depth_mm[sample.v * image.width + sample.u]);
    if (part_feature(image, sample.u, sample.v, scale, split) < split.threshold_mm) {
      *left_end++ = sample;
    } else {
      right_.push_back(sample);
    }
  }
  const auto left_size = static_cast<std::size_t>(left_end - node.samples.begin());
  std::copy(right_.begin(), right_.end(), left_end);
  return {split,
          {GrowingNode{node.samples.first(left_size), 2 * node.path, node.depth + 1, {}},
           GrowingNode{node.samples.subspan(left_size), 2 * node.path + 1, node.depth + 1, {}}}};
}

std::vector<std::optional<GrownSplit>> TreeGrower::split(std::span<const GrowingNode> nodes) {
  std::vector<std::optional<GrownSplit>> result(nodes.size());
  std::vector<const GrowingNode*> searched;
  for (const GrowingNode& node : nodes) {
    if (may_split(node)) searched.push_back(&node);
  }
  if (searched.empty()) return result;
  const auto splits = search(searched);

  std::vector<std::int64_t> left_parts(searched.size() * kPartCount, 0);
  for (std::size_t i = 0; i < searched.size(); ++i) {
    if (!splits[i]) continue;
    auto& grown = result[static_cast<std::size_t>(searched[i] - nodes.data())];
    grown = partition(*searched[i], *splits[i]);
    std::ranges::copy(count_parts(grown->children[0].samples),
                      left_parts.begin() + static_cast<std::ptrdiff_t>(i * kPartCount));
  }
  ranks_.sum(left_parts);
  for (std::size_t i = 0; i < searched.size(); ++i) {
    if (!splits[i]) continue;
    auto& [left, right] = result[static_cast<std::size_t>(searched[i] - nodes.data())]->children;
    for (std::size_t part = 0; part < kPartCount; ++part) {
      left.parts[part] = left_parts[i * kPartCount + part];
      right.parts[part] = searched[i]->parts[part] - left.parts[part];
    }
  }
  return result;
}

Tree TreeGrower::grow(const GrowingNode& root, const std::stop_token& stop) {
  struct Link {
    std::size_t parent;
    std::size_t side;
  };
  constexpr std::size_t kNoParent = ~std::size_t{0};
  const std::size_t at_once = nodes_at_once(options_, ranks_);
  Tree tree;
  std::vector<GrowingNode> leaves;
  std::vector<GrowingNode> open = {root};
  std::vector<Link> links = {{kNoParent, 0}};  // of the open nodes
  while (!open.empty()) {
    if (any_rank(ranks_, stop.stop_requested())) return {};
    const std::size_t rest = open.size() - std::min(open.size(), at_once);
    const std::vector<GrowingNode> nodes(open.begin() + static_cast<std::ptrdiff_t>(rest), open.end());
    const std::vector<Link> parents(links.begin() + static_cast<std::ptrdiff_t>(rest), links.end());
    open.resize(rest);
    links.resize(rest);
    const auto grown = split(nodes);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      std::int32_t self = 0;
      if (grown[i]) {
        self = static_cast<std::int32_t>(tree.nodes.size());
        tree.nodes.push_back(grown[i]->node);
        for (const std::size_t side : {1U, 0U}) {
          open.push_back(grown[i]->children[side]);
          links.push_back({tree.nodes.size() - 1, side});
        }
      } else {
        self = ~static_cast<std::int32_t>(leaves.size());
        leaves.push_back(nodes[i]);
      }
      if (parents[i].parent != kNoParent) tree.nodes[parents[i].parent].child[parents[i].side] = self;
    }
  }
  tree.leaves = make_leaves(persons_, leaves, tree_seed_, ranks_);
  return from_the_left(tree);
}

}  // namespace armature
