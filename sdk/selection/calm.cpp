#include "sdk/selection/calm.h"

#include <vector>

#include <Eigen/Core>

namespace armature::sdk {

std::optional<Mesh> without_noise(const Mesh& mesh, const Adjacency& adjacency) {
  using Eigen::Vector3d;
  std::vector<Vector3d> positions = mesh.positions;
  std::vector<Vector3d> d(positions.size());
  constexpr int kMostRounds = 20;
  int round = 0;
  for (; round < kMostRounds; ++round) {
    for (std::size_t v = 0; v < positions.size(); ++v) {
      const auto neighbours = adjacency.neighbours(VertexId(v));
      Vector3d sum = Vector3d::Zero();
      for (const VertexId other : neighbours) sum += positions[other.index()];
      d[v] = neighbours.empty() ? Vector3d(Vector3d::Zero())
                                : Vector3d(positions[v] - sum / static_cast<double>(neighbours.size()));
    }
    double agreement = 0;
    for (const auto& [a, b] : adjacency.edges()) agreement += d[a.index()].dot(d[b.index()]);
    if (!(agreement < 0)) break;
    for (std::size_t v = 0; v < positions.size(); ++v) positions[v] -= 0.5 * d[v];
  }
  if (round == 0) return std::nullopt;
  return Mesh{.positions = std::move(positions), .triangles = mesh.triangles};
}

}  // namespace armature::sdk
