#include "tracker/forest/forest.h"

#include <algorithm>
#include <utility>

namespace armature {
namespace {

std::string place(std::size_t tree, const char* what, std::size_t i) {
  return "tree " + std::to_string(tree) + ", " + what + " " + std::to_string(i) + ": ";
}

bool valid_child(std::int32_t child, std::size_t parent, const Tree& tree) {
  // A child always stands behind its parent, so a walk cannot run in circles.
  if (child >= 0)
    return static_cast<std::size_t>(child) > parent && static_cast<std::size_t>(child) < tree.nodes.size();
  return static_cast<std::size_t>(~child) < tree.leaves.size();
}

Expected<void> check(const Tree& tree, std::size_t t) {
  if (tree.leaves.empty()) return fail("tree " + std::to_string(t) + " has no leaves");
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const SplitNode& node = tree.nodes[i];
    for (const std::int32_t child : node.child) {
      if (!valid_child(child, i, tree)) {
        return fail(place(t, "node", i) + "child " + std::to_string(child) + " is not behind it in the tree");
      }
    }
    for (const std::int16_t probe : {node.u_mm[0], node.u_mm[1], node.v_mm[0], node.v_mm[1]}) {
      if (probe < -kMaxProbe_mm || probe > kMaxProbe_mm) {
        return fail(place(t, "node", i) + "probe of " + std::to_string(probe) + " mm, expected at most " +
                    std::to_string(kMaxProbe_mm));
      }
    }
  }
  for (std::size_t i = 0; i < tree.leaves.size(); ++i) {
    for (const LeafVote& vote : tree.leaves[i].votes) {
      if (vote.joint != LeafVote::kNone && vote.joint >= kJointCount) {
        return fail(place(t, "leaf", i) + "vote for joint " + std::to_string(vote.joint) + " of " +
                    std::to_string(kJointCount));
      }
    }
  }
  return {};
}

}  // namespace

std::uint8_t vote_weight_code(float weight) noexcept {
  const auto* const found =
      std::find_if(kVoteWeights.begin(), kVoteWeights.end() - 1, [&](float w) { return w <= weight; });
  return static_cast<std::uint8_t>(found - kVoteWeights.begin());
}

Forest::Forest(std::vector<Tree> trees, std::string command) : trees_(std::move(trees)), command_(std::move(command)) {}

Expected<Forest> Forest::create(std::vector<Tree> trees, std::string command) {
  if (trees.empty() || trees.size() > kMaxTrees) {
    return fail("a forest has 1 to " + std::to_string(kMaxTrees) + " trees, not " + std::to_string(trees.size()));
  }
  for (std::size_t t = 0; t < trees.size(); ++t) {
    if (const auto checked = check(trees[t], t); !checked) return tl::unexpected(checked.error());
  }
  return Forest(std::move(trees), std::move(command));
}

Expected<Forest> Forest::corrected_by(Perceptron correction) const {
  if (correction.inputs() != kCorrectionInputs || correction.outputs() != kCorrectionOutputs) {
    return fail("a correction of " + std::to_string(correction.inputs()) + " inputs and " +
                std::to_string(correction.outputs()) + " outputs, expected " + std::to_string(kCorrectionInputs) +
                " and " + std::to_string(kCorrectionOutputs));
  }
  Forest out = *this;
  out.correction_ = std::move(correction);
  return out;
}

int Forest::depth() const {
  int deepest = 0;
  for (const Tree& tree : trees_) {
    std::vector<int> depth_of(tree.nodes.size(), 1);
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
      deepest = std::max(deepest, depth_of[i]);
      for (const std::int32_t child : tree.nodes[i].child) {
        // Every path counts: a node that two parents share (never made by the trainer) has the longer one.
        if (child >= 0)
          depth_of[static_cast<std::size_t>(child)] =
              std::max(depth_of[static_cast<std::size_t>(child)], depth_of[i] + 1);
      }
    }
  }
  return deepest;
}

}  // namespace armature
