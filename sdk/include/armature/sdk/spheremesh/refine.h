#pragma once

#include <cstddef>
#include <vector>

#include <armature/sdk/error.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/spheremesh/sphere_mesh.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// How a sphere-mesh is fitted to a mesh.
struct RefineOptions {
  /// Gauss-Newton steps.
  int iterations = 30;
  /// Points taken of either surface; 0 leaves it to the number of spheres.
  std::size_t samples = 0;
  /// How much the largest distances count beside the mean ones.
  double tail = 0.5;
  /// Spheres that stay as they are.
  std::vector<SphereId> pinned = {};
};

/// Moves the spheres of a sphere-mesh so that the interpolated geometry comes close to a mesh, both ways: the sum of
/// the mean distance from the mesh to the union's outer boundary and back, and of a high power of the distance that
/// holds down the largest ones. Gauss-Newton on all centres and radii. Goes beyond the decimation, which fits spheres
/// to regions and never looks at what lies between them (thesis, section 4.9). Deterministic; the same at every scale.
/// Fails for options out of range and shapes that name spheres that are not there.
[[nodiscard]] Expected<SphereMesh> refine(const Mesh& mesh, const SphereMesh& start, const RefineOptions& options = {},
                                          const Task& task = {});

}  // namespace armature::sdk
