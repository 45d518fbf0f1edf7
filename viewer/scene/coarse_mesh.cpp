#include "viewer/scene/coarse_mesh.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include <armature/sdk/mesh/measures.h>
#include <armature/sdk/spheremesh/sphere_triangle.h>

namespace armature::viewer {
namespace {

/// The number of each vertex's cell, counted from 0 in the order of the grid.
std::vector<std::uint32_t> cells_of(const sdk::Mesh& mesh, std::size_t cells) {
  const Eigen::AlignedBox3d box = sdk::bounding_box(mesh);
  const double width = box.sizes().maxCoeff() / static_cast<double>(cells);
  std::vector<std::uint64_t> keys;
  keys.reserve(mesh.positions.size());
  for (const Eigen::Vector3d& position : mesh.positions) {
    std::uint64_t key = 0;
    for (int d = 0; d < 3; ++d)
      key = key << 21 | static_cast<std::uint64_t>(width > 0 ? (position[d] - box.min()[d]) / width : 0);
    keys.push_back(key);
  }
  std::vector<std::uint64_t> occupied = keys;
  std::ranges::sort(occupied);
  occupied.erase(std::unique(occupied.begin(), occupied.end()), occupied.end());
  std::vector<std::uint32_t> numbers;
  numbers.reserve(keys.size());
  for (const std::uint64_t key : keys)
    numbers.push_back(static_cast<std::uint32_t>(std::ranges::lower_bound(occupied, key) - occupied.begin()));
  return numbers;
}

}  // namespace

CoarseMesh coarse_mesh(const sdk::Mesh& mesh, std::size_t cells) {
  CoarseMesh coarse;
  if (mesh.positions.empty()) return coarse;
  const std::vector<std::uint32_t> cell = cells_of(mesh, cells);
  const std::size_t count = std::ranges::max(cell) + std::size_t{1};
  std::vector<double> members(count, 0);
  coarse.mesh.positions.assign(count, Eigen::Vector3d::Zero());
  for (std::size_t v = 0; v < cell.size(); ++v) {
    coarse.mesh.positions[cell[v]] += mesh.positions[v];
    ++members[cell[v]];
  }
  for (std::size_t c = 0; c < count; ++c) coarse.mesh.positions[c] /= members[c];

  struct Kept {
    std::array<std::uint32_t, 3> corners;  // the lowest first
    std::uint32_t face;
  };
  std::vector<Kept> kept;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) corners[k] = cell[mesh.triangles[f][k].index()];
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    std::rotate(corners.begin(), std::ranges::min_element(corners), corners.end());
    kept.push_back({corners, static_cast<std::uint32_t>(f)});
  }
  std::ranges::stable_sort(kept, {}, &Kept::corners);
  const auto alike = [](const Kept& a, const Kept& b) { return a.corners == b.corners; };
  kept.erase(std::unique(kept.begin(), kept.end(), alike), kept.end());
  for (const auto& [corners, face] : kept) {
    coarse.mesh.triangles.push_back({sdk::VertexId(corners[0]), sdk::VertexId(corners[1]), sdk::VertexId(corners[2])});
    coarse.source.emplace_back(face);
  }
  return coarse;
}

sdk::Mesh facets(const sdk::SphereMesh& shape) {
  sdk::Mesh mesh;
  for (const auto& [a, b, c] : shape.triangles) {
    const auto normals = sdk::tangent_normals({shape.sphere(a), shape.sphere(b), shape.sphere(c)});
    if (!normals) continue;
    std::array<sdk::SphereId, 3> corners = {a, b, c};
    for (const Eigen::Vector3d& normal : *normals) {
      const std::size_t first = mesh.positions.size();
      for (const sdk::SphereId corner : corners)
        mesh.positions.push_back(shape.sphere(corner).centre + shape.sphere(corner).radius * normal);
      mesh.triangles.push_back({sdk::VertexId(first), sdk::VertexId(first + 1), sdk::VertexId(first + 2)});
      std::swap(corners[1], corners[2]);  // the other is seen from the other side
    }
  }
  return mesh;
}

}  // namespace armature::viewer
