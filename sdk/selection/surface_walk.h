#pragma once

#include <Eigen/Core>
#include <armature/sdk/distance/mesh_tree.h>
#include <armature/sdk/mesh/adjacency.h>
#include <armature/sdk/mesh/mesh.h>

namespace armature::sdk {

/// Where one arrives who walks on a surface in a plane: along the curve in which it meets the plane through `start`
/// that holds `direction` and `up`, until `distance` away from the start in space. So small folds do not turn the walk.
/// Ends early at a boundary. Where more than two faces meet, the way goes on in the face that bends it least.
[[nodiscard]] SurfacePoint walk(const Mesh& mesh, const Adjacency& adjacency, const SurfacePoint& start,
                                const Eigen::Vector3d& direction, const Eigen::Vector3d& up, double distance);

/// The corner of a face that is closest to a point on it.
[[nodiscard]] VertexId closest_corner(const Mesh& mesh, const SurfacePoint& point);

}  // namespace armature::sdk
