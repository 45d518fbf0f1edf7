#pragma once

#include <algorithm>
#include <map>

#include <armature/sdk/mesh/mesh.h>

namespace armature::sdk {

/// A unit sphere: an octahedron whose triangles were quartered so many times; 4^(n+1) + 2 vertices.
inline Mesh ball(int subdivisions) {
  Mesh mesh;
  mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  const auto face = [](std::size_t a, std::size_t b, std::size_t c) {
    return Triangle{VertexId(a), VertexId(b), VertexId(c)};
  };
  mesh.triangles = {face(0, 2, 4), face(2, 1, 4), face(1, 3, 4), face(3, 0, 4),
                    face(2, 0, 5), face(1, 2, 5), face(3, 1, 5), face(0, 3, 5)};
  for (int k = 0; k < subdivisions; ++k) {
    std::map<std::pair<VertexId, VertexId>, VertexId> middles;
    const auto middle = [&](VertexId a, VertexId b) {
      const auto [found, added] = middles.try_emplace(std::minmax(a, b), VertexId(mesh.positions.size()));
      if (added) mesh.positions.push_back((mesh.position(a) + mesh.position(b)).normalized());
      return found->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const VertexId ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  return mesh;
}

/// Two unit spheres that do not touch.
inline Mesh two_balls(int subdivisions) {
  Mesh mesh = ball(subdivisions);
  const std::size_t count = mesh.positions.size();
  for (std::size_t k = 0; k < count; ++k) mesh.positions.push_back(mesh.positions[k] + Eigen::Vector3d(3, 0, 0));
  const std::size_t faces = mesh.triangles.size();
  for (std::size_t k = 0; k < faces; ++k) {
    auto triangle = mesh.triangles[k];
    for (auto& corner : triangle) corner = VertexId(corner.index() + count);
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

/// Everything that is wrong with meshes: triangles between any vertices, repeated ones, ones that repeat a corner,
/// points at one place, vertices on no triangle. The same every time.
inline Mesh soup(std::size_t vertices) {
  Mesh mesh;
  std::uint32_t state = 12345;
  const auto next = [&](std::uint32_t below) {
    state = state * 1664525U + 1013904223U;
    return (state >> 8) % below;
  };
  for (std::size_t k = 0; k < vertices; ++k) mesh.positions.emplace_back(next(6), next(6), next(6));
  const auto any = [&] { return VertexId(next(static_cast<std::uint32_t>(vertices - 2))); };
  for (std::size_t k = 0; k < 2 * vertices; ++k) mesh.triangles.push_back({any(), any(), any()});
  mesh.triangles.push_back(mesh.triangles.front());
  return mesh;
}

}  // namespace armature::sdk
