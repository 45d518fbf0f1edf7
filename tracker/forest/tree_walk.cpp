#include "tracker/forest/tree_walk.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace armature {
namespace {

using Node = TreeWalk::Node;

constexpr std::size_t kLanes = 64;
constexpr std::size_t kProbes = 2 * kLanes;  // u and v of each lane side by side
constexpr unsigned kThresholdBits = 16;
constexpr unsigned kChildBits = 24;
constexpr std::uint32_t kChildMask = (1U << kChildBits) - 1;

std::uint32_t packed(std::array<std::int16_t, 2> probe_mm) {
  return static_cast<std::uint16_t>(probe_mm[0]) | std::uint32_t{static_cast<std::uint16_t>(probe_mm[1])} << 16U;
}

std::uint64_t packed(std::int32_t child) {
  return child >= 0 ? static_cast<std::uint32_t>(child) : static_cast<std::uint32_t>(~child) | TreeWalk::kLeaf;
}

std::uint32_t child_of(std::uint64_t decision, int feature_mm) {
  const auto threshold_mm = static_cast<std::int16_t>(decision);
  const unsigned right = feature_mm >= threshold_mm ? 1 : 0;
  return static_cast<std::uint32_t>(decision >> (kThresholdBits + kChildBits * right)) & kChildMask;
}

/// The pixels that are on their way, each at a node.
struct Lanes {
  std::array<std::uint32_t, kProbes> probe_mm{};
  std::array<std::int32_t, kProbes> u{}, v{}, scale_x{}, scale_y{};  // of the pixel
  std::array<std::int32_t, kProbes> address{};                       // of the probe in the image
  std::array<std::uint64_t, kLanes> decision{};
  std::array<std::uint32_t, kLanes> pixel{}, at{};

  void start(std::size_t lane, std::uint32_t index, const WalkStart& from) {
    for (std::size_t i = 2 * lane; i < 2 * lane + 2; ++i) {
      u[i] = from.u;
      v[i] = from.v;
      scale_x[i] = from.scale.x;
      scale_y[i] = from.scale.y;
    }
    pixel[lane] = index;
  }
  void move(std::size_t from, std::size_t to) {
    for (std::size_t k = 0; k < 2; ++k) {
      for (auto* values : {&u, &v, &scale_x, &scale_y, &address}) (*values)[2 * to + k] = (*values)[2 * from + k];
    }
    decision[to] = decision[from];
    pixel[to] = pixel[from];
  }
  void stand_at(std::size_t lane, const Node& node) {
    probe_mm[2 * lane] = node.u_mm;
    probe_mm[2 * lane + 1] = node.v_mm;
    decision[lane] = node.decision;
  }
};

/// The same as probe() but for the load. Integers only: wider registers change nothing about the result.
[[gnu::always_inline]] inline void find_addresses(Lanes& lanes, const PersonImage& image) {
  const std::int32_t right = image.width - 1, bottom = image.height - 1, width = image.width;
  for (std::size_t i = 0; i < kProbes; ++i) {
    const std::int32_t x_mm = static_cast<std::int32_t>(lanes.probe_mm[i] << 16U) >> 16;
    const std::int32_t y_mm = static_cast<std::int32_t>(lanes.probe_mm[i]) >> 16;
    const std::int32_t x = std::clamp(lanes.u[i] + ((x_mm * lanes.scale_x[i] + 32768) >> 16), 0, right);
    const std::int32_t y = std::clamp(lanes.v[i] + ((y_mm * lanes.scale_y[i] + 32768) >> 16), 0, bottom);
    lanes.address[i] = y * width + x;
  }
}

[[gnu::always_inline]] inline void walk(std::span<const Node> nodes, const PersonImage& image,
                                        std::span<const WalkStart> starts, std::span<std::uint32_t> leaves) {
  Lanes lanes;
  std::size_t active = std::min(kLanes, starts.size());
  for (std::size_t lane = 0; lane < active; ++lane) {
    lanes.start(lane, static_cast<std::uint32_t>(lane), starts[lane]);
    lanes.stand_at(lane, nodes[0]);
  }
  auto next = static_cast<std::uint32_t>(active);
  while (active > 0) {
    find_addresses(lanes, image);
    for (std::size_t lane = 0; lane < active;) {
      const int feature_mm = image.depth_mm[lanes.address[2 * lane]] - image.depth_mm[lanes.address[2 * lane + 1]];
      std::uint32_t at = child_of(lanes.decision[lane], feature_mm);
      if ((at & TreeWalk::kLeaf) != 0) {
        leaves[lanes.pixel[lane]] = at & ~TreeWalk::kLeaf;
        if (next == starts.size()) {
          // Nobody waits: the last lane takes this place.
          lanes.move(--active, lane);
          continue;
        }
        lanes.start(lane, next, starts[next]);
        ++next;
        at = 0;
      }
      __builtin_prefetch(&nodes[at]);
      lanes.at[lane++] = at;
    }
    for (std::size_t lane = 0; lane < active; ++lane) lanes.stand_at(lane, nodes[lanes.at[lane]]);
  }
}

void walk_plain(std::span<const Node> nodes, const PersonImage& image, std::span<const WalkStart> starts,
                std::span<std::uint32_t> leaves) {
  walk(nodes, image, starts, leaves);
}
#if defined(__x86_64__)
[[gnu::target("avx2,bmi2")]] void walk_avx2(std::span<const Node> nodes, const PersonImage& image,
                                            std::span<const WalkStart> starts, std::span<std::uint32_t> leaves) {
  walk(nodes, image, starts, leaves);
}
bool has_avx2() {
  return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("bmi2") != 0;
}
#else
constexpr auto walk_avx2 = walk_plain;
bool has_avx2() {
  return false;
}
#endif

}  // namespace

TreeWalk::TreeWalk(const Tree& tree) {
  assert(tree.nodes.size() <= kLeaf && tree.leaves.size() <= kLeaf);
  nodes_.reserve(tree.nodes.size());
  for (const SplitNode& node : tree.nodes) {
    nodes_.push_back({packed(node.u_mm), packed(node.v_mm),
                      static_cast<std::uint16_t>(node.threshold_mm) | packed(node.child[0]) << kThresholdBits |
                          packed(node.child[1]) << (kThresholdBits + kChildBits)});
  }
}

void TreeWalk::find_leaves(const PersonImage& image, std::span<const WalkStart> starts,
                           std::span<std::uint32_t> leaves) const noexcept {
  if (nodes_.empty()) {
    std::ranges::fill(leaves, 0U);
    return;
  }
  (has_avx2() ? walk_avx2 : walk_plain)(nodes_, image, starts, leaves);
}

}  // namespace armature
