#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <armature/sdk/laplacian/laplacian.h>

#include "sdk/laplacian/intrinsic_triangulation.h"

namespace armature::sdk {

Laplacian laplacian(const Mesh& mesh, const Adjacency& adjacency) {
  IntrinsicTriangulation triangulation = intrinsic_triangulation(mesh, adjacency);
  const std::vector<double> cotangents = flip_to_delaunay(triangulation);
  const double layer = 1.0 / triangulation.layers;
  const auto vertices = static_cast<Eigen::Index>(mesh.positions.size());

  Laplacian result{.stiffness = {vertices, vertices}, .mass = Eigen::VectorXd::Zero(vertices)};
  const auto& lengths = triangulation.lengths;
  for (std::size_t i = 0; i < triangulation.corners.size(); ++i) {
    const double third = layer / 3 * area_of_sides(lengths[3 * i], lengths[3 * i + 1], lengths[3 * i + 2]);
    for (const std::uint32_t corner : triangulation.corners[i]) result.mass[corner] += third;
  }

  // Column by column: room for the diagonal and every edge at the vertex, then sorted, equal rows merged.
  Eigen::SparseMatrix<double>& L = result.stiffness;
  std::vector<int> edges(mesh.positions.size(), 1);
  const auto is_edge = [&](Side side) {
    return side < triangulation.glued[side] && triangulation.from(side) != triangulation.to(side);
  };
  for (Side side = 0; side < triangulation.glued.size(); ++side) {
    if (!is_edge(side)) continue;
    ++edges[triangulation.from(side)];
    ++edges[triangulation.to(side)];
  }
  std::vector<std::size_t> starts(edges.size() + 1, 0);
  std::partial_sum(edges.begin(), edges.end(), starts.begin() + 1);
  std::vector<std::pair<int, double>> entries(starts.back());
  std::vector<std::size_t> ends(starts.begin(), starts.end() - 1);
  for (Side side = 0; side < triangulation.glued.size(); ++side) {
    if (!is_edge(side)) continue;
    const std::uint32_t a = triangulation.from(side);
    const std::uint32_t b = triangulation.to(side);
    // Below zero by rounding alone.
    const double weight = std::max(0.0, 0.5 * layer * (cotangents[side] + cotangents[triangulation.glued[side]]));
    entries[ends[a]++] = {static_cast<int>(b), -weight};
    entries[ends[b]++] = {static_cast<int>(a), -weight};
  }
  L.reserve(edges);
  for (std::size_t v = 0; v < edges.size(); ++v) {
    const auto begin = entries.begin() + static_cast<std::ptrdiff_t>(starts[v]);
    auto end = entries.begin() + static_cast<std::ptrdiff_t>(ends[v]);
    double sum = 0;
    for (auto entry = begin; entry != end; ++entry) sum -= entry->second;
    *end++ = {static_cast<int>(v), sum};
    std::sort(begin, end, [](const auto& x, const auto& y) { return x.first < y.first; });
    const auto column = static_cast<Eigen::Index>(v);
    for (auto entry = begin; entry != end;) {
      double value = 0;
      const int row = entry->first;
      for (; entry != end && entry->first == row; ++entry) value += entry->second;
      L.insert(row, column) = value;
    }
  }
  L.makeCompressed();
  return result;
}

}  // namespace armature::sdk
