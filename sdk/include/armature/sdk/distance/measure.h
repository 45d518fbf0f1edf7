#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/error.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/mesh/point_set.h>
#include <armature/sdk/spheremesh/sphere_mesh.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// How closely shapes are compared.
struct MeasureOptions {
  std::size_t samples = 200'000;  ///< points on either surface, spread evenly by area
  /// Of a sphere-mesh, seconds where a hundred thousand spheres take minutes: distances are exact at the samples as
  /// ever, but the vertices of the input count by a lower bound of theirs and creases not at all, so that the Hausdorff
  /// distance is found or fallen short of.
  bool quick = false;
};

/// How far an approximation leaves its input, in percent of the diagonal of the input's bounding box (thesis, table
/// 4.1).
struct ApproximationErrors {
  double hausdorff = 0;                    ///< the largest distance from either surface to the other (H)
  double mean_input_to_approximation = 0;  ///< over the area of the input (M12)
  double mean_approximation_to_input = 0;  ///< over the area of the approximation (M21)
};

/// Compares a mesh with a sphere-mesh, of which the outer surface counts: closed voids inside do not. Distances are
/// exact at points that are spread evenly by area; the Hausdorff distance is the largest over these, all vertices of
/// the input and the creases of the approximation. The same on every run and with any number of threads. An input
/// without faces or of no size, or an approximation without spheres, is refused.
[[nodiscard]] Expected<ApproximationErrors> measure(const Mesh& input, const SphereMesh& approximation,
                                                    const MeasureOptions& options = {}, const Task& task = {});

/// The same for an approximation that is a mesh; all of its surface counts.
[[nodiscard]] Expected<ApproximationErrors> measure(const Mesh& input, const Mesh& approximation,
                                                    const MeasureOptions& options = {}, const Task& task = {});

/// About `count` points of a mesh, spread evenly by area: with n of them, each part of the surface holds its share of n
/// to within a point or two. The same on every run. A mesh without area gives the corners of its faces.
[[nodiscard]] std::vector<Eigen::Vector3d> sample_surface(const Mesh& mesh, std::size_t count);
/// The same with the normals of the faces that they are on; zero where the mesh has no area. Colours are left out.
[[nodiscard]] PointSet sample_points(const Mesh& mesh, std::size_t count);

}  // namespace armature::sdk
