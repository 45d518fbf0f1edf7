#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tracker/forest/part_feature.h"

namespace armature {

/// Where a walk down a tree starts: a pixel of a person image.
struct WalkStart {
  std::int32_t u = 0, v = 0;
  ProbeScale scale;
};

/// A tree laid out for walking: 16 bytes a node, and what a walk does not need left out. Many pixels walk together, so
/// that the cache misses of one hide behind the work of the others. Immutable. Thread-safe: yes.
class TreeWalk {
 public:
  explicit TreeWalk(const Tree& tree);

  /// The index of the leaf in which each pixel ends, in the order of `starts`. The same on every machine.
  /// Realtime-safe: yes.
  void find_leaves(const PersonImage& image, std::span<const WalkStart> starts,
                   std::span<std::uint32_t> leaves) const noexcept;

  /// A probe is x in the lower and y in the upper 16 bits; `decision` is, from the lowest bit on, 16 bits of the
  /// threshold and 24 bits for each child: a node's index, or a leaf's with kLeaf set.
  struct Node {
    std::uint32_t u_mm = 0, v_mm = 0;
    std::uint64_t decision = 0;
  };
  static constexpr std::uint32_t kLeaf = 1U << 23U;

 private:
  std::vector<Node> nodes_;
};

}  // namespace armature
