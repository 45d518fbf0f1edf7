#include "sdk/selection/min_cut.h"

#include <algorithm>

namespace armature::sdk {

void MinCut::join(std::size_t a, std::size_t b, std::int64_t capacity) {
  if (a == b) return;
  edges_[a].push_back({b, edges_[b].size(), capacity});
  edges_[b].push_back({a, edges_[a].size() - 1, capacity});
}

bool MinCut::find_levels(std::size_t source, std::size_t sink) {
  levels_.assign(edges_.size(), -1);
  levels_[source] = 0;
  std::vector<std::size_t> reached = {source};
  for (std::size_t i = 0; i < reached.size(); ++i)
    for (const Edge& edge : edges_[reached[i]]) {
      if (edge.left == 0 || levels_[edge.to] >= 0) continue;
      levels_[edge.to] = levels_[reached[i]] + 1;
      reached.push_back(edge.to);
    }
  return levels_[sink] >= 0;
}

/// Pushes along ways to the sink, level by level, until none is left. A way goes on from where the one before it has
/// filled an edge.
void MinCut::push_all(std::size_t source, std::size_t sink, const Task& task) {
  constexpr std::size_t kNowAndThen = 1U << 16U;
  next_.assign(edges_.size(), 0);
  std::vector<Edge*> way;
  const auto tail = [this](const Edge& edge) { return edges_[edge.to][edge.back].to; };
  std::size_t at = source;
  for (std::size_t step = 1; step % kNowAndThen != 0 || !task.stopped(); ++step) {
    if (at == sink) {
      const auto flow = (*std::ranges::min_element(way, {}, &Edge::left))->left;
      for (Edge* edge : way) {
        edge->left -= flow;
        edges_[edge->to][edge->back].left += flow;
      }
      const auto filled = std::ranges::find(way, 0, &Edge::left);
      at = tail(**filled);
      way.erase(filled, way.end());
      continue;
    }
    std::size_t& i = next_[at];
    while (i < edges_[at].size() && (edges_[at][i].left == 0 || levels_[edges_[at][i].to] != levels_[at] + 1)) ++i;
    if (i < edges_[at].size()) {
      way.push_back(&edges_[at][i]);
      at = way.back()->to;
    } else if (way.empty()) {
      return;
    } else {
      // A dead end: back, and never again this way.
      at = tail(*way.back());
      way.pop_back();
      ++next_[at];
    }
  }
}

std::vector<bool> MinCut::source_side(std::size_t source, std::size_t sink, const Task& task) {
  while (!task.stopped() && find_levels(source, sink)) push_all(source, sink, task);
  std::vector<bool> side(edges_.size());
  for (std::size_t i = 0; i < side.size(); ++i) side[i] = levels_[i] >= 0;
  return side;
}

}  // namespace armature::sdk
