#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <armature/sdk/error.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/spheremesh/sphere_mesh.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// On which side of the mesh a sphere-mesh may err.
enum class FitMode : std::uint8_t {
  Best,   ///< on both: the least error
  Inner,  ///< within the mesh, refused if it is not closed: its surface enters no interpolated sphere by more than 0.1
          ///< % of the bounding box's diagonal (`containment()` tells by how much). Simplices that must leave it are
          ///< taken away
  Outer,  ///< around the mesh: no point of its surface is outside
};

/// How a sphere-mesh is fitted to a mesh.
struct RefineOptions {
  FitMode mode = FitMode::Best;  ///< on which side it may err
  /// How often, at most, spheres are moved to where the error is and the connectivity is repaired, each time with some
  /// steps of Gauss-Newton; a kept round that gains less than 1 % is the last one. 0 keeps the connectivity. Without a
  /// number: 2, or 3 from 75 spheres on, which gain more by it.
  std::optional<int> rounds = std::nullopt;
  /// Steps of Gauss-Newton in a round; four times as many in all where there are no rounds.
  int steps = 8;
  /// Points taken of either surface; 0 leaves it to the number of spheres.
  std::size_t samples = 0;
  /// How much the largest distances count beside the mean ones.
  double tail = 1;
  /// Spheres that stay as they are, and keep their ids.
  std::vector<SphereId> pinned = {};
};

/// Fits a sphere-mesh to a mesh so that the interpolated geometry comes close, both ways: the mean distance from the
/// mesh to the union's outer boundary and back, and a high power of the distance that holds down the largest ones.
/// Gauss-Newton on all centres and radii, in turns with changes of the connectivity that local errors pay for: spheres
/// added where the error is, others joined where that costs least, simplices dropped, filled in and flipped. As many
/// spheres as before. Goes beyond the decimation, which fits spheres to regions and never looks at what lies between
/// them (thesis, section 4.9). Deterministic; the same at every scale. Fails for options out of range and shapes that
/// name spheres that are not there. A mesh without area changes nothing.
[[nodiscard]] Expected<SphereMesh> refine(const Mesh& mesh, const SphereMesh& start, const RefineOptions& options = {},
                                          const Task& task = {});

/// For every vertex of a mesh the sphere that has most weight in the nearest interpolated one: which vertices each
/// sphere of any sphere-mesh stands for. The sphere-mesh must not be empty.
[[nodiscard]] std::vector<SphereId> nearest_spheres(const Mesh& mesh, const SphereMesh& shape);

}  // namespace armature::sdk
