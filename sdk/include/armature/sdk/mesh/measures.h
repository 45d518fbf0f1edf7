#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <armature/sdk/mesh/adjacency.h>
#include <armature/sdk/mesh/mesh.h>

namespace armature::sdk {

/// The smallest axis-aligned box around all positions, used by a face or not. Empty for a mesh without any.
[[nodiscard]] Eigen::AlignedBox3d bounding_box(const Mesh& mesh);
/// The diagonal of that box; 0 for a mesh without positions.
[[nodiscard]] double bounding_box_diagonal(const Mesh& mesh);

/// Half the cross product of two sides: as long as the face's area, along its outward normal.
[[nodiscard]] inline Eigen::Vector3d area_vector(const Mesh& mesh, FaceId face) noexcept {
  const Eigen::Vector3d& a = mesh.corner(face, 0);
  return 0.5 * (mesh.corner(face, 1) - a).cross(mesh.corner(face, 2) - a);
}

/// By FaceId.
[[nodiscard]] std::vector<double> face_areas(const Mesh& mesh);
/// The sum of all faces' areas.
[[nodiscard]] double surface_area(const Mesh& mesh);
/// Unit normals by FaceId, outward where corners turn counter-clockwise seen from outside; zero for a face without
/// area.
[[nodiscard]] std::vector<Eigen::Vector3d> face_normals(const Mesh& mesh);
/// Unit normals by VertexId: the sum of the faces' normals, each weighted by its angle at the vertex (Thurmer and
/// Wuthrich 1998); zero where that sum is zero or no face is.
[[nodiscard]] std::vector<Eigen::Vector3d> vertex_normals(const Mesh& mesh);

/// The area of every vertex's barycentric cell, by VertexId: a third of the areas of its faces (thesis, section 4.6.1).
[[nodiscard]] std::vector<double> barycentric_areas(const Mesh& mesh);
/// Appends the corner points of a vertex's barycentric cell: the vertex itself, then of every face at it two midpoints
/// of sides and the centroid. Midpoints shared by two faces come twice.
void append_cell_points(const Mesh& mesh, const Adjacency& adjacency, VertexId vertex,
                        std::vector<Eigen::Vector3d>& out);

}  // namespace armature::sdk
