#include <array>
#include <cmath>

#include <armature/sdk/mesh/measures.h>

#include "sdk/mesh/lengths.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

/// The directions of a face's sides, that from corner k to corner k + 1 at place k.
std::array<Vector3d, 3> side_directions(const Mesh& mesh, FaceId face) {
  std::array<Vector3d, 3> sides;
  for (std::size_t k = 0; k < 3; ++k) sides[k] = direction_of(mesh.corner(face, (k + 1) % 3) - mesh.corner(face, k));
  return sides;
}

/// A face's unit normal out of the directions of its sides.
Vector3d normal_of(const std::array<Vector3d, 3>& sides) {
  return direction_of(sides[2].cross(sides[0]));
}

}  // namespace

Eigen::AlignedBox3d bounding_box(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& position : mesh.positions) box.extend(position);
  return box;
}

double bounding_box_diagonal(const Mesh& mesh) {
  return mesh.positions.empty() ? 0 : bounding_box(mesh).diagonal().stableNorm();
}

std::vector<double> face_areas(const Mesh& mesh) {
  std::vector<double> areas(mesh.triangles.size());
  for (std::size_t i = 0; i < areas.size(); ++i) areas[i] = area_vector(mesh, FaceId(i)).stableNorm();
  return areas;
}

double surface_area(const Mesh& mesh) {
  double sum = 0;
  for (const double area : face_areas(mesh)) sum += area;
  return sum;
}

std::vector<Vector3d> face_normals(const Mesh& mesh) {
  std::vector<Vector3d> normals(mesh.triangles.size());
  for (std::size_t i = 0; i < normals.size(); ++i) normals[i] = normal_of(side_directions(mesh, FaceId(i)));
  return normals;
}

std::vector<Vector3d> vertex_normals(const Mesh& mesh) {
  std::vector<Vector3d> normals(mesh.positions.size(), Vector3d::Zero());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto sides = side_directions(mesh, FaceId(i));
    const Vector3d normal = normal_of(sides);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3d& ahead = sides[k];
      const Vector3d& behind = sides[(k + 2) % 3];  // ends at this corner
      const double angle = std::atan2(behind.cross(ahead).norm(), -behind.dot(ahead));
      normals[mesh.triangles[i][k].index()] += angle * normal;
    }
  }
  for (Vector3d& normal : normals) normal = direction_of(normal);
  return normals;
}

std::vector<double> barycentric_areas(const Mesh& mesh) {
  std::vector<double> areas(mesh.positions.size(), 0);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const double third = area_vector(mesh, FaceId(i)).stableNorm() / 3;
    for (const VertexId vertex : mesh.triangles[i]) areas[vertex.index()] += third;
  }
  return areas;
}

void append_cell_points(const Mesh& mesh, const Adjacency& adjacency, VertexId vertex, std::vector<Vector3d>& out) {
  const Vector3d& here = mesh.position(vertex);
  out.push_back(here);
  for (const FaceId face : adjacency.faces(vertex)) {
    Vector3d sum = Vector3d::Zero();
    for (const VertexId corner : mesh.triangle(face)) {
      sum += mesh.position(corner);
      if (corner != vertex) out.push_back(0.5 * (here + mesh.position(corner)));
    }
    out.push_back(sum / 3);
  }
}

}  // namespace armature::sdk
