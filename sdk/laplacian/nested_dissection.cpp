#include "sdk/laplacian/nested_dissection.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

namespace armature::sdk {
namespace {

/// A group this small is one block: cutting it further would make the blocks too small to be worth their overhead.
constexpr std::size_t kLeaf = 8;
/// Groups larger than this are cut by tasks of their own.
constexpr std::size_t kTask = 2048;

constexpr std::uint32_t kNone = 0xFFFF'FFFF;

/// A part of the graph by itself, numbered from 0, so that what belongs together lies together in memory.
struct Group {
  std::vector<std::uint32_t> ids = {};                    ///< rows of the matrix
  std::vector<std::uint32_t> starts = {};                 ///< [size + 1], in `neighbours`
  std::vector<std::uint32_t> neighbours = {};             ///< within the group
  std::array<std::vector<std::uint32_t>, 3> sorted = {};  ///< along each axis

  [[nodiscard]] std::uint32_t size() const noexcept { return static_cast<std::uint32_t>(ids.size()); }
  [[nodiscard]] std::span<const std::uint32_t> around(std::uint32_t i) const noexcept {
    return std::span(neighbours).subspan(starts[i], starts[i + 1] - starts[i]);
  }
};

/// Where a group falls in two: behind the first `below` along an axis.
struct Cut {
  double cost = std::numeric_limits<double>::infinity();
  std::size_t axis = 0;
  std::uint32_t below = 0;
};

/// The narrowest cut across an axis: for every place at once, how many vertices before it have a neighbour behind.
Cut best_cut(const Group& group, std::size_t axis) {
  const auto& along = group.sorted[axis];
  const std::uint32_t n = group.size();
  std::vector<std::uint32_t> place(n);
  for (std::uint32_t i = 0; i < n; ++i) place[along[i]] = i;
  std::vector<std::int32_t> change(n, 0);
  for (std::uint32_t vertex = 0; vertex < n; ++vertex) {
    std::uint32_t last = place[vertex];
    for (const std::uint32_t other : group.around(vertex)) last = std::max(last, place[other]);
    ++change[place[vertex]];
    --change[last];
  }
  Cut best;
  std::int32_t width = 0;
  for (std::uint32_t i = 0; i + 1 < n; ++i) {
    width += change[i];
    const double share = static_cast<double>(i + 1) / n;
    constexpr double kLeastShare = 0.2;
    if (share < kLeastShare || share > 1 - kLeastShare) continue;
    const double skew = 2 * share - 1;
    const double cost = (width + 0.5) * (1 + skew * skew);
    if (cost < best.cost) best = {cost, axis, i + 1};
  }
  return best;
}

enum Side : std::uint8_t { kLower, kUpper, kSeparator };

/// The fewest vertices that touch every edge between the two sides (Koenig 1931), by augmenting paths.
std::vector<std::uint32_t> smallest_cover(const Group& group, std::span<const std::uint8_t> side) {
  std::vector<std::uint32_t> low;
  std::vector<std::vector<std::uint32_t>> across;
  std::vector<std::uint32_t> partner(group.size(), kNone);
  for (std::uint32_t vertex = 0; vertex < group.size(); ++vertex) {
    if (side[vertex] != kLower) continue;
    bool crosses = false;
    for (const std::uint32_t other : group.around(vertex)) {
      if (side[other] == kLower) continue;
      if (!crosses) {
        low.push_back(vertex);
        across.emplace_back();
      }
      crosses = true;
      across.back().push_back(other);
    }
  }
  const auto count = static_cast<std::uint32_t>(low.size());
  std::vector<std::uint32_t> matched(count, kNone);
  // A search by breadth for each, so that no path is too long for the stack.
  std::vector<std::uint32_t> seen_by(group.size(), kNone);
  std::vector<std::uint32_t> came_from(group.size(), kNone);
  std::vector<std::uint32_t> waiting;
  for (std::uint32_t root = 0; root < count; ++root) {
    waiting.assign(1, root);
    std::uint32_t end = kNone;
    for (std::size_t at = 0; at < waiting.size() && end == kNone; ++at)
      for (const std::uint32_t other : across[waiting[at]]) {
        if (seen_by[other] == root) continue;
        seen_by[other] = root;
        came_from[other] = waiting[at];
        if (partner[other] == kNone) {
          end = other;
          break;
        }
        waiting.push_back(partner[other]);
      }
    while (end != kNone) {
      const std::uint32_t i = came_from[end];
      const std::uint32_t before = matched[i];
      partner[end] = i;
      matched[i] = end;
      end = i == root ? kNone : before;
    }
  }
  // What an alternating path reaches from an unmatched vertex below is covered from above.
  std::vector<bool> reached(count, false);
  std::vector<std::uint32_t> cover;
  waiting.clear();
  for (std::uint32_t i = 0; i < count; ++i)
    if (matched[i] == kNone) {
      waiting.push_back(i);
      reached[i] = true;
    }
  for (std::size_t at = 0; at < waiting.size(); ++at)
    for (const std::uint32_t other : across[waiting[at]]) {
      if (partner[other] == kNone || reached[partner[other]]) continue;
      reached[partner[other]] = true;
      cover.push_back(other);
      waiting.push_back(partner[other]);
    }
  for (std::uint32_t i = 0; i < count; ++i)
    if (!reached[i]) cover.push_back(low[i]);
  return cover;
}

/// One side of a cut by itself.
Group extract(const Group& group, std::span<const std::uint8_t> side, Side which, std::span<std::uint32_t> renumbered) {
  Group result;
  for (std::uint32_t vertex = 0; vertex < group.size(); ++vertex)
    if (side[vertex] == which) {
      renumbered[vertex] = result.size();
      result.ids.push_back(group.ids[vertex]);
    }
  result.starts.reserve(result.ids.size() + 1);
  result.starts.push_back(0);
  for (std::uint32_t vertex = 0; vertex < group.size(); ++vertex) {
    if (side[vertex] != which) continue;
    for (const std::uint32_t other : group.around(vertex))
      if (side[other] == which) result.neighbours.push_back(renumbered[other]);
    result.starts.push_back(static_cast<std::uint32_t>(result.neighbours.size()));
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    result.sorted[axis].reserve(result.ids.size());
    for (const std::uint32_t vertex : group.sorted[axis])
      if (side[vertex] == which) result.sorted[axis].push_back(renumbered[vertex]);
  }
  return result;
}

/// Orders a group into the places from `begin`: lower side, upper side, separator.
void dissect(Group group, std::size_t begin, std::span<std::uint32_t> order, std::span<std::uint8_t> block_begins,
             const Task& task) {
  if (task.stopped()) return;
  const auto finish = [&](std::span<const std::uint32_t> vertices, std::size_t at) {
    if (vertices.empty()) return;
    block_begins[at] = 1;
    for (const std::uint32_t vertex : vertices) order[at++] = group.ids[vertex];
  };
  Cut cut;
  if (group.size() > kLeaf)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Cut candidate = best_cut(group, axis);
      if (candidate.cost < cut.cost) cut = candidate;
    }
  if (cut.below == 0) {
    finish(group.sorted[0], begin);
    return;
  }

  std::vector<std::uint8_t> side(group.size(), kUpper);
  for (std::uint32_t i = 0; i < cut.below; ++i) side[group.sorted[cut.axis][i]] = kLower;
  const std::vector<std::uint32_t> separator = smallest_cover(group, side);
  for (const std::uint32_t vertex : separator) side[vertex] = kSeparator;
  std::vector<std::uint32_t> renumbered(group.size());
  Group lower = extract(group, side, kLower, renumbered);
  Group upper = extract(group, side, kUpper, renumbered);
  finish(separator, begin + lower.size() + upper.size());
  const bool large = group.size() > kTask;
  group = {};
  const std::size_t middle = begin + lower.size();
  const auto first = [&] { dissect(std::move(lower), begin, order, block_begins, task); };
  const auto second = [&] { dissect(std::move(upper), middle, order, block_begins, task); };
  if (large) {
    tbb::parallel_invoke(first, second);
  } else {
    first();
    second();
  }
}

}  // namespace

Dissection nested_dissection(const Eigen::SparseMatrix<double>& matrix, std::span<const Eigen::Vector3d> positions,
                             const Task& task) {
  const auto n = static_cast<std::uint32_t>(positions.size());
  Group all;
  // In their order along an axis, so that neighbours lie close together in memory whatever their order in the mesh.
  std::array<std::vector<std::uint32_t>, 3> sorted;
  tbb::parallel_for(0, 3, [&](int axis) {
    std::vector<std::pair<double, std::uint32_t>> keys(n);
    for (std::uint32_t i = 0; i < n; ++i) keys[i] = {positions[i][axis], i};
    std::sort(keys.begin(), keys.end());
    auto& along = sorted[static_cast<std::size_t>(axis)];
    along.resize(n);
    std::transform(keys.begin(), keys.end(), along.begin(), [](const auto& key) { return key.second; });
  });
  std::vector<std::uint32_t> renumbered(n);
  all.ids = sorted[0];
  for (std::uint32_t i = 0; i < n; ++i) renumbered[all.ids[i]] = i;
  all.starts.push_back(0);
  for (const std::uint32_t id : all.ids) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(matrix, id); entry; ++entry)
      if (entry.row() != entry.col()) all.neighbours.push_back(renumbered[static_cast<std::size_t>(entry.row())]);
    all.starts.push_back(static_cast<std::uint32_t>(all.neighbours.size()));
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    all.sorted[axis].resize(n);
    std::transform(sorted[axis].begin(), sorted[axis].end(), all.sorted[axis].begin(),
                   [&](std::uint32_t id) { return renumbered[id]; });
  }

  Dissection result{.order = std::vector<std::uint32_t>(n)};
  std::vector<std::uint8_t> block_begins(n, 0);
  if (n > 0) dissect(std::move(all), 0, result.order, block_begins, task);
  for (std::uint32_t i = 0; i < n; ++i)
    if (block_begins[i] != 0) result.blocks.push_back(i);
  result.blocks.push_back(n);
  return result;
}

}  // namespace armature::sdk
