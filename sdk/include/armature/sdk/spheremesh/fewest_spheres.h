#pragma once

#include <cstddef>
#include <functional>

#include <armature/sdk/error.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/spheremesh/sphere_mesh.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// Makes a sphere-mesh of so many spheres: a level of a hierarchy, say, refined or not.
using Approximate = std::function<Expected<SphereMesh>(std::size_t spheres)>;

/// How far an approximation may leave its input, and with how many spheres.
struct ErrorBound {
  double percent = 0;     ///< most mean distance from the input to the approximation (M12), of the box's diagonal
  std::size_t least = 1;  ///< spheres to begin with
  std::size_t most = 0;   ///< spheres to end with
};

/// The sphere-mesh with the fewest spheres that keeps the bound: counts are doubled from `least` on until one does,
/// then halved in between. Errors do not fall strictly with the number of spheres; what is returned keeps the bound,
/// and one sphere less does not, where they do. Fails if `most` spheres do not keep it either, and as `approximate`
/// fails.
[[nodiscard]] Expected<SphereMesh> fewest_spheres(const Mesh& mesh, const ErrorBound& bound,
                                                  const Approximate& approximate, const Task& task = {});

}  // namespace armature::sdk
