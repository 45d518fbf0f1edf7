#include "tracker/forest/tree_codec.h"

namespace armature {
namespace {

constexpr std::uint64_t kNodeBytes = 18;
constexpr std::uint64_t kLeafBytes = kPartCount + 5 * kVotesPerLeaf;

}  // namespace

void put_tree(ByteWriter& out, const Tree& tree) {
  out.put(static_cast<std::uint32_t>(tree.nodes.size()));
  out.put(static_cast<std::uint32_t>(tree.leaves.size()));
  for (const SplitNode& node : tree.nodes) {
    for (const std::int16_t x : node.u_mm) out.put(x);
    for (const std::int16_t x : node.v_mm) out.put(x);
    out.put(node.threshold_mm);
    for (const std::int32_t child : node.child) out.put(child);
  }
  for (const Leaf& leaf : tree.leaves) {
    for (std::size_t part = 0; part < kPartCount; ++part) out.put(leaf.probability[part]);
    for (const LeafVote& vote : leaf.votes) {
      for (const std::int8_t x : vote.offset) out.put(x);
      out.put(vote.joint);
      out.put(vote.weight_code);
    }
  }
}

std::optional<Tree> get_tree(ByteReader& in) {
  if (in.left() < 8) return {};
  const auto node_count = in.get<std::uint32_t>();
  const auto leaf_count = in.get<std::uint32_t>();
  if (in.left() < node_count * kNodeBytes + leaf_count * kLeafBytes) return {};
  Tree tree;
  tree.nodes.resize(node_count);
  for (SplitNode& node : tree.nodes) {
    for (std::int16_t& x : node.u_mm) x = in.get<std::int16_t>();
    for (std::int16_t& x : node.v_mm) x = in.get<std::int16_t>();
    node.threshold_mm = in.get<std::int16_t>();
    for (std::int32_t& child : node.child) child = in.get<std::int32_t>();
  }
  tree.leaves.resize(leaf_count);
  for (Leaf& leaf : tree.leaves) {
    for (std::size_t part = 0; part < kPartCount; ++part) leaf.probability[part] = in.get<std::uint8_t>();
    for (LeafVote& vote : leaf.votes) {
      for (std::int8_t& x : vote.offset) x = in.get<std::int8_t>();
      vote.joint = in.get<std::uint8_t>();
      vote.weight_code = in.get<std::uint8_t>();
    }
  }
  return tree;
}

}  // namespace armature
