#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/mesh/adjacency.h>
#include <armature/sdk/mesh/mesh.h>

namespace armature::sdk {

/// The middle of a face's corners.
[[nodiscard]] inline Eigen::Vector3d middle(const Mesh& mesh, FaceId face) {
  return (mesh.corner(face, 0) + mesh.corner(face, 1) + mesh.corner(face, 2)) / 3;
}

/// What hangs together with some faces and is wanted (`bool wanted(FaceId)`); the seeds that are wanted first. In the
/// order in which it is reached. `beside(face, reach)` calls `reach` for all that lies beside a face.
template <class Beside, class Wanted>
[[nodiscard]] std::vector<FaceId> flood_over(const Beside& beside, std::span<const FaceId> seeds, std::size_t faces,
                                             const Wanted& wanted) {
  std::vector<bool> seen(faces);
  std::vector<FaceId> reached;
  const auto reach = [&](FaceId face) {
    if (seen[face.index()]) return;
    seen[face.index()] = true;
    if (wanted(face)) reached.push_back(face);
  };
  for (const FaceId face : seeds) reach(face);
  for (std::size_t i = 0; i < reached.size(); ++i) beside(FaceId(reached[i]), reach);
  return reached;
}

/// The same by the edges of a mesh.
template <class Wanted>
[[nodiscard]] std::vector<FaceId> flood(const Adjacency& adjacency, std::span<const FaceId> seeds, std::size_t faces,
                                        const Wanted& wanted) {
  const auto beside = [&](FaceId face, const auto& reach) {
    for (const EdgeId edge : adjacency.edges(face))
      if (edge.valid())
        for (const FaceId next : adjacency.faces(edge)) reach(next);
  };
  return flood_over(beside, seeds, faces, wanted);
}

}  // namespace armature::sdk
