#include "sdk/selection/level_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>
#include <armature/sdk/mesh/measures.h>

namespace armature::sdk {
namespace {

/// Sets of vertices that grow together, each with its area and its highest vertex.
class Regions {
 public:
  Regions(std::span<const double> field, std::span<const double> areas)
      : field_(field), parent_(field.size()), area_(areas.begin(), areas.end()), tip_(field.size()) {
    std::iota(parent_.begin(), parent_.end(), 0U);
    std::iota(tip_.begin(), tip_.end(), 0U);
  }
  std::uint32_t find(std::uint32_t v) {
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a == b) return;
    if (area_[a] < area_[b] || (area_[a] == area_[b] && b < a)) std::swap(a, b);
    parent_[b] = a;
    area_[a] += area_[b];
    if (field_[tip_[b]] > field_[tip_[a]]) tip_[a] = tip_[b];
  }
  [[nodiscard]] double area(std::uint32_t root) const { return area_[root]; }
  [[nodiscard]] std::uint32_t tip(std::uint32_t root) const { return tip_[root]; }

 private:
  std::span<const double> field_;
  std::vector<std::uint32_t> parent_;
  std::vector<double> area_;
  std::vector<std::uint32_t> tip_;
};

/// Where an isoline crosses a face.
struct Segment {
  double length = 0;
  double gradient = 0;
  VertexId above;
};

Segment segment_of(const Mesh& mesh, FaceId face, std::span<const double> field, double level) {
  const Triangle& corners = mesh.triangle(face);
  const auto value = [&](std::size_t k) { return field[corners[k].index()]; };
  std::array<bool, 3> above{};
  for (std::size_t k = 0; k < 3; ++k) above[k] = value(k) > level;
  // The corner that is alone on its side.
  std::size_t alone = 0;
  for (std::size_t k = 0; k < 3; ++k)
    if (above[k] != above[(k + 1) % 3] && above[k] != above[(k + 2) % 3]) alone = k;
  const auto cross = [&](std::size_t to) {
    const double t = (level - value(alone)) / (value(to) - value(alone));
    return Eigen::Vector3d(mesh.corner(face, alone) + t * (mesh.corner(face, to) - mesh.corner(face, alone)));
  };
  const std::size_t b = (alone + 1) % 3;
  const std::size_t c = (alone + 2) % 3;
  Segment result{.above = corners[above[alone] ? alone : b]};
  result.length = (cross(b) - cross(c)).norm();
  const Eigen::Vector3d area = area_vector(mesh, face);
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < 3; ++k)
    gradient += value(k) * (mesh.corner(face, (k + 2) % 3) - mesh.corner(face, (k + 1) % 3));
  const double twice = 2 * area.norm();
  result.gradient = twice > 0 ? gradient.norm() / twice : 0;
  if (!std::isfinite(result.length) || !std::isfinite(result.gradient)) result.length = result.gradient = 0;
  return result;
}

}  // namespace

LevelTree::LevelTree(const Surface& surface, std::span<const double> field, std::vector<double> levels) {
  const Mesh& mesh = surface.mesh;
  // Which faces each level crosses: from the first level below the highest corner to the last above the lowest.
  const auto level_below = [&](double value) {
    return std::lower_bound(levels.begin(), levels.end(), value, [](double level, double v) { return level >= v; }) -
           levels.begin();
  };
  std::vector<std::vector<FaceId>> crossing(levels.size());
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    if (repeats_a_vertex(mesh.triangles[f])) continue;
    const auto& [a, b, c] = mesh.triangles[f];
    const auto [low, high] = std::minmax({field[a.index()], field[b.index()], field[c.index()]});
    for (auto k = level_below(high); k < level_below(low); ++k) crossing[static_cast<std::size_t>(k)].emplace_back(f);
  }
  std::vector<std::uint32_t> order(field.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return field[a] > field[b] || (field[a] == field[b] && a < b); });

  Regions regions(field, surface.vertex_areas);
  std::vector<std::uint32_t> node_of(field.size(), LevelNode::kNone);  // by root, at this level
  std::vector<std::uint32_t> open;                                     // nodes without a parent yet
  std::size_t added = 0;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    for (; added < order.size() && field[order[added]] > levels[k]; ++added)
      for (const VertexId neighbour : surface.adjacency.neighbours(VertexId(order[added])))
        if (field[neighbour.index()] > levels[k])
          regions.join(order[added], static_cast<std::uint32_t>(neighbour.index()));
    const auto first = static_cast<std::uint32_t>(nodes_.size());
    for (const FaceId face : crossing[k]) {
      const Segment segment = segment_of(mesh, face, field, levels[k]);
      const std::uint32_t root = regions.find(static_cast<std::uint32_t>(segment.above.index()));
      if (node_of[root] == LevelNode::kNone) {
        node_of[root] = static_cast<std::uint32_t>(nodes_.size());
        nodes_.push_back(
            {.level = levels[k], .area = regions.area(root), .tip = VertexId(regions.tip(root)), .through = face});
      }
      LevelNode& node = nodes_[node_of[root]];
      node.girth += segment.length;
      node.flux += segment.length * segment.gradient;
    }
    std::vector<std::uint32_t> still_open;
    for (const std::uint32_t child : open) {
      const std::uint32_t parent = node_of[regions.find(static_cast<std::uint32_t>(nodes_[child].tip.index()))];
      if (parent == LevelNode::kNone || parent < first) {
        still_open.push_back(child);
        continue;
      }
      nodes_[child].parent = parent;
      std::uint32_t& main = nodes_[parent].main_child;
      if (main == LevelNode::kNone || nodes_[child].area > nodes_[main].area) main = child;
    }
    open = std::move(still_open);
    for (std::uint32_t n = first; n < nodes_.size(); ++n) {
      LevelNode& node = nodes_[n];
      node_of[regions.find(static_cast<std::uint32_t>(node.tip.index()))] = LevelNode::kNone;
      const auto slope = [](const LevelNode& of) { return of.girth > 0 ? of.flux / of.girth : 0; };
      if (node.main_child != LevelNode::kNone) {
        const LevelNode& child = nodes_[node.main_child];
        const double mean = 0.5 * (slope(node) + slope(child));
        node.along = child.along + (mean > 0 ? (child.level - node.level) / mean : 0);
      } else {
        node.along = slope(node) > 0 ? (field[node.tip.index()] - node.level) / slope(node) : 0;
      }
      open.push_back(n);
    }
  }
  number();
}

double LevelTree::girth_at(std::uint32_t node, double way) const {
  const double target = nodes_[node].along + way;
  std::uint32_t at = node;
  if (way <= 0) {
    while (true) {
      const std::uint32_t child = nodes_[at].main_child;
      const double low = child == LevelNode::kNone ? 0 : nodes_[child].along;
      const double low_girth = child == LevelNode::kNone ? 0 : nodes_[child].girth;
      if (target >= low) {
        const double span = nodes_[at].along - low;
        const double t = span > 0 ? (target - low) / span : 0;
        return low_girth + t * (nodes_[at].girth - low_girth);
      }
      if (child == LevelNode::kNone) return 0;
      at = child;
    }
  }
  // A parent that another child is the main one of has another tip: its way counts from the step up.
  double along = nodes_[at].along;
  while (nodes_[at].parent != LevelNode::kNone) {
    const std::uint32_t parent = nodes_[at].parent;
    const double a = nodes_[at].girth > 0 ? nodes_[at].flux / nodes_[at].girth : 0;
    const double b = nodes_[parent].girth > 0 ? nodes_[parent].flux / nodes_[parent].girth : 0;
    const double step = a + b > 0 ? 2 * (nodes_[at].level - nodes_[parent].level) / (a + b) : 0;
    if (along + step >= target) {
      const double t = step > 0 ? (target - along) / step : 0;
      return nodes_[at].girth + t * (nodes_[parent].girth - nodes_[at].girth);
    }
    along += step;
    at = parent;
  }
  return nodes_[at].girth;
}

void LevelTree::number() {
  const std::size_t count = nodes_.size();
  held_.assign(count, 1);
  for (std::size_t n = 0; n < count; ++n)  // children come before parents
    if (nodes_[n].parent != LevelNode::kNone) held_[nodes_[n].parent] += held_[n];
  entered_.assign(count, 0);
  std::vector<std::uint32_t> next(count);  // by node, where the next child enters
  std::uint32_t next_root = 0;
  for (std::size_t n = count; n-- > 0;) {
    std::uint32_t& place = nodes_[n].parent == LevelNode::kNone ? next_root : next[nodes_[n].parent];
    entered_[n] = place;
    place += held_[n];
    next[n] = entered_[n] + 1;
  }
}

bool LevelTree::nested(std::uint32_t a, std::uint32_t b) const {
  const auto holds = [&](std::uint32_t outer, std::uint32_t inner) {
    return entered_[inner] >= entered_[outer] && entered_[inner] < entered_[outer] + held_[outer];
  };
  return holds(a, b) || holds(b, a);
}

std::vector<double> spread_levels(const Surface& surface, std::span<const double> field) {
  constexpr int kByValue = 160;
  constexpr int kByArea = 96;
  if (field.empty()) return {};
  const auto [low, high] = std::minmax_element(field.begin(), field.end());
  std::vector<double> levels;
  for (int i = 1; i < kByValue; ++i) levels.push_back(*low + (*high - *low) * i / kByValue);
  // Quantiles of the area, by counting.
  constexpr std::size_t kBins = 1U << 14U;
  std::vector<double> bins(kBins, 0);
  double total = 0;
  for (std::size_t v = 0; v < field.size(); ++v) {
    const double t = (field[v] - *low) / (*high - *low);
    if (!std::isfinite(t)) return {};
    bins[std::min(kBins - 1, static_cast<std::size_t>(t * kBins))] += surface.vertex_areas[v];
    total += surface.vertex_areas[v];
  }
  double passed = 0;
  int next = 1;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    passed += bins[bin];
    if (passed < total * next / kByArea) continue;
    while (next < kByArea && passed >= total * next / kByArea) ++next;
    levels.push_back(*low + (*high - *low) * (static_cast<double>(bin) + 1) / kBins);
  }
  std::sort(levels.begin(), levels.end(), std::greater<>());
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  return levels;
}

}  // namespace armature::sdk
