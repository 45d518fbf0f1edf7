#include "sdk/expansion/face_graph.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <tbb/parallel_for.h>

namespace armature::sdk {

using Eigen::Vector3d;

FaceGraph::FaceGraph(const Surface& surface) : surface_(&surface), nodes_(surface.mesh.triangles.size() + 1) {
  const Mesh& mesh = surface.mesh;
  const Adjacency& adjacency = surface.adjacency;
  const std::size_t count = mesh.triangles.size();
  for (std::size_t f = 0; f < count; ++f) {
    std::size_t beside = 0;
    for (const EdgeId edge : adjacency.edges(FaceId(f)))
      if (edge.valid()) beside += adjacency.faces(edge).size() - 1;
    nodes_[f + 1].first = nodes_[f].first + static_cast<std::uint32_t>(beside);
  }
  beside_.resize(nodes_[count].first);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t f) {
    const FaceId face(f);
    Node& node = nodes_[f];
    node.middle = sdk::middle(mesh, face);
    double spread = 0;
    for (std::size_t k = 0; k < 3; ++k) spread = std::max(spread, (mesh.corner(face, k) - node.middle).norm());
    node.spread = std::nextafter(static_cast<float>(spread), std::numeric_limits<float>::infinity());
    std::size_t next = node.first;
    for (const EdgeId edge : adjacency.edges(face))
      if (edge.valid())
        for (const FaceId other : adjacency.faces(edge))
          if (other != face) beside_[next++] = other;
  });
}

bool FaceGraph::touches(FaceId face, const Vector3d& centre, double radius) const noexcept {
  const Node& node = nodes_[face.index()];
  const double distance = (node.middle - centre).norm();
  const auto spread = static_cast<double>(node.spread);
  if (distance > radius + spread) return false;
  if (distance <= radius) return true;
  const Mesh& mesh = surface_->mesh;
  return std::ranges::any_of(mesh.triangle(face),
                             [&](VertexId v) { return (mesh.position(v) - centre).squaredNorm() <= radius * radius; });
}

}  // namespace armature::sdk
