#include "viewer/scene/shading.h"

#include <cmath>
#include <cstdint>

#include <Eigen/Geometry>

namespace armature::viewer {
namespace {

using Eigen::Vector3d;

/// Corners around each vertex, as 3 face + corner, in the order of the faces.
struct CornersOfVertices {
  std::vector<std::uint32_t> first;    // by VertexId, one more at the end
  std::vector<std::uint32_t> corners;  // from first[v] up to first[v + 1]

  explicit CornersOfVertices(const sdk::Mesh& mesh)
      : first(mesh.positions.size() + 1, 0), corners(3 * mesh.triangles.size()) {
    for (const sdk::Triangle& triangle : mesh.triangles)
      for (const sdk::VertexId vertex : triangle) ++first[vertex.index() + 1];
    for (std::size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (std::size_t face = 0; face < mesh.triangles.size(); ++face)
      for (std::size_t k = 0; k < 3; ++k)
        corners[next[mesh.triangles[face][k].index()]++] = static_cast<std::uint32_t>(3 * face + k);
  }
};

double angle_between(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

std::vector<std::array<Vector3d, 3>> corner_normals(const sdk::Mesh& mesh, double crease_rad) {
  const double least_cosine = std::cos(crease_rad);
  const std::size_t faces = mesh.triangles.size();
  std::vector<Vector3d> normals(faces);  // unit length, or zero
  std::vector<std::array<double, 3>> angles(faces);
  for (std::size_t f = 0; f < faces; ++f) {
    const sdk::FaceId face(f);
    const std::array<Vector3d, 3> p = {mesh.corner(face, 0), mesh.corner(face, 1), mesh.corner(face, 2)};
    normals[f] = (p[1] - p[0]).stableNormalized().cross((p[2] - p[0]).stableNormalized()).stableNormalized();
    for (std::size_t k = 0; k < 3; ++k) angles[f][k] = angle_between(p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
  }

  const CornersOfVertices around(mesh);
  std::vector<std::array<Vector3d, 3>> result(faces);
  for (std::size_t f = 0; f < faces; ++f) {
    const bool flat = normals[f].isZero();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t vertex = mesh.triangles[f][k].index();
      Vector3d sum = Vector3d::Zero();
      for (std::uint32_t i = around.first[vertex]; i < around.first[vertex + 1]; ++i) {
        const std::size_t other = around.corners[i] / 3;
        if (flat || normals[f].dot(normals[other]) >= least_cosine)
          sum += angles[other][around.corners[i] % 3] * normals[other];
      }
      result[f][k] = sum.isZero() ? normals[f] : sum.normalized();
    }
  }
  return result;
}

}  // namespace armature::viewer
