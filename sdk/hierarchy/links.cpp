#include "sdk/hierarchy/links.h"

#include <algorithm>
#include <utility>

namespace armature::sdk {
namespace {

using Pair = CollapseComplex::Pair;

/// The place of a point of the unit cube about the origin along a curve that fills it.
std::uint64_t morton_code(const Eigen::Vector3d& point) noexcept {
  constexpr int kBits = 21;
  std::uint64_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double along = std::clamp(point[axis] + 0.5, 0.0, 1.0) * ((1 << kBits) - 1);
    const auto cell = static_cast<std::uint64_t>(along);
    for (int bit = 0; bit < kBits; ++bit) code |= (cell >> bit & 1U) << (3 * bit + axis);
  }
  return code;
}

/// Indices of the points, in the order of that curve.
std::vector<std::uint32_t> morton_order(std::span<const Eigen::Vector3d> points) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> coded;
  coded.reserve(points.size());
  for (std::uint32_t k = 0; k < points.size(); ++k) coded.emplace_back(morton_code(points[k]), k);
  std::sort(coded.begin(), coded.end());
  std::vector<std::uint32_t> order;
  order.reserve(points.size());
  for (const auto& [code, k] : coded) order.push_back(k);
  return order;
}

}  // namespace

std::vector<Pair> links_of_loose_vertices(const NormalisedShape& shape, std::span<const std::uint32_t> labels) {
  std::vector<bool> loose(shape.positions.size(), true);
  for (const auto& triangle : shape.triangles)
    for (const auto corner : triangle) loose[corner] = false;
  if (std::find(loose.begin(), loose.end(), true) == loose.end()) return {};

  // The nearest among a few on either side along the curve is near enough for what weighs nothing.
  constexpr int kReach = 8;
  const auto order = morton_order(shape.positions);
  std::vector<Pair> links;
  std::vector<std::vector<std::uint32_t>> candidates(shape.positions.size());
  const auto sweep = [&](auto first, auto last) {
    std::vector<std::uint32_t> recent;
    for (auto at = first; at != last; ++at) {
      if (!loose[*at]) {
        recent.push_back(*at);
        continue;
      }
      int found = 0;
      for (auto k = recent.rbegin(); k != recent.rend() && found < kReach; ++k, ++found)
        if (labels.empty() || labels[*k] == labels[*at]) candidates[*at].push_back(*k);
    }
  };
  sweep(order.begin(), order.end());
  sweep(order.rbegin(), order.rend());
  for (std::uint32_t v = 0; v < candidates.size(); ++v) {
    if (candidates[v].empty()) continue;
    const auto nearest =
        *std::min_element(candidates[v].begin(), candidates[v].end(), [&](std::uint32_t a, std::uint32_t b) {
          return (shape.positions[a] - shape.positions[v]).squaredNorm() <
                 (shape.positions[b] - shape.positions[v]).squaredNorm();
        });
    links.push_back({nearest, v});
  }
  return links;
}

std::vector<Pair> links_between_components(std::span<const std::uint32_t> slots,
                                           std::span<const Eigen::Vector3d> centres) {
  constexpr std::size_t kAllPairs = 256;
  constexpr std::size_t kAlongCurve = 8;
  const bool all = slots.size() <= kAllPairs;
  const auto order = morton_order(centres);
  std::vector<Pair> links;
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < (all ? order.size() : std::min(order.size(), i + 1 + kAlongCurve)); ++j)
      links.push_back({slots[order[i]], slots[order[j]]});
  return links;
}

}  // namespace armature::sdk
