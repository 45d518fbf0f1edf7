#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <armature/sdk/task.h>

namespace armature::sdk {

/// The least cut of a graph between two of its nodes (Dinic 1970). Capacities are whole numbers, so that the cut is the
/// same everywhere; of several least cuts, the one closest to the source.
class MinCut {
 public:
  explicit MinCut(std::size_t nodes) : edges_(nodes), levels_(nodes) {}

  /// Joins two nodes by an edge that can carry so much either way. Not negative.
  void join(std::size_t a, std::size_t b, std::int64_t capacity);
  /// By node, whether it lies on the source's side. Of no use where the task was stopped.
  [[nodiscard]] std::vector<bool> source_side(std::size_t source, std::size_t sink, const Task& task = {});

 private:
  struct Edge {
    std::size_t to;
    std::size_t back;  // its place among the edges of `to`
    std::int64_t left;
  };
  [[nodiscard]] bool find_levels(std::size_t source, std::size_t sink);
  void push_all(std::size_t source, std::size_t sink, const Task& task);

  std::vector<std::vector<Edge>> edges_;
  std::vector<int> levels_;
  std::vector<std::size_t> next_;
};

}  // namespace armature::sdk
