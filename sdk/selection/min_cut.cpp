#include "sdk/selection/min_cut.h"

#include <algorithm>
#include <limits>

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

bool MinCut::push_one(std::size_t source, std::size_t sink) {
  std::vector<Edge*> way;
  std::size_t at = source;
  while (at != sink) {
    std::size_t& i = next_[at];
    while (i < edges_[at].size() && (edges_[at][i].left == 0 || levels_[edges_[at][i].to] != levels_[at] + 1)) ++i;
    if (i < edges_[at].size()) {
      way.push_back(&edges_[at][i]);
      at = way.back()->to;
    } else if (way.empty()) {
      return false;
    } else {
      // A dead end: back, and never again this way.
      const Edge& last = *way.back();
      at = edges_[last.to][last.back].to;
      way.pop_back();
      ++next_[at];
    }
  }
  std::int64_t flow = std::numeric_limits<std::int64_t>::max();
  for (const Edge* edge : way) flow = std::min(flow, edge->left);
  for (Edge* edge : way) {
    edge->left -= flow;
    edges_[edge->to][edge->back].left += flow;
  }
  return true;
}

std::vector<bool> MinCut::source_side(std::size_t source, std::size_t sink) {
  while (find_levels(source, sink)) {
    next_.assign(edges_.size(), 0);
    while (push_one(source, sink)) {
    }
  }
  std::vector<bool> side(edges_.size());
  for (std::size_t i = 0; i < side.size(); ++i) side[i] = levels_[i] >= 0;
  return side;
}

}  // namespace armature::sdk
