#pragma once

#include <vector>

#include <armature/sdk/spheremesh/sphere_mesh.h>
#include <armature/sdk/task.h>

#include "sdk/spheremesh/union_fit.h"

namespace armature::sdk {

/// How long to look for a better connectivity.
struct SearchEffort {
  int rounds;       ///< 0: steps alone
  int first_steps;  ///< of Gauss-Newton, before the rounds
  int steps;        ///< in a round
};

/// Fits a sphere-mesh and changes where its spheres are and what joins them, with as many spheres: every round adds
/// some where the union is farthest from the input, joins others where that costs least, repairs the connectivity, and
/// is kept only if the loss has fallen; a kept one that gains less than 1 % is the last. Fixed spheres keep their
/// places.
void search(UnionFit& fit, SphereMesh& shape, const SearchEffort& effort, const std::vector<bool>& fixed,
            const Task& task);

}  // namespace armature::sdk
