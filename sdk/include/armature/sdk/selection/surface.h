#pragma once

#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/distance/mesh_tree.h>
#include <armature/sdk/error.h>
#include <armature/sdk/mesh/adjacency.h>
#include <armature/sdk/mesh/mesh.h>

namespace armature::sdk {

/// A mesh with what the selection tools look at, found once when it is loaded. Refers to the mesh, which must outlive
/// it unchanged. Thread-safe to read.
struct Surface {
  /// Takes time n log n in the mesh.
  explicit Surface(const Mesh& of_mesh);

  const Mesh& mesh;                             ///< as it came
  Adjacency adjacency;                          ///< of its elements
  MeshTree tree;                                ///< for closest points
  std::vector<Eigen::Vector3d> vertex_normals;  ///< see `vertex_normals()`
  std::vector<double> vertex_areas;             ///< see `barycentric_areas()`
  double diagonal = 0;                          ///< of the bounding box
};

/// How far a stroke may pass over a surface, as a part of the bounding box's diagonal.
inline constexpr double kFarthestStroke = 0.05;

/// The closest points of the surface to those of a stroke, one each. Refused with the number of the first point that
/// lies farther away than `kFarthestStroke` of the diagonal, or that is not finite. `what` names the stroke in
/// messages.
[[nodiscard]] Expected<std::vector<SurfacePoint>> project_stroke(const Surface& surface,
                                                                 const std::vector<Eigen::Vector3d>& stroke,
                                                                 std::string_view what);

}  // namespace armature::sdk
