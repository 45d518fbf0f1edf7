#pragma once

#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/spheremesh/sphere_mesh.h>

namespace armature::viewer {

///@{
/// A sphere around all of it, about the middle of its bounding box; of radius 1 about the origin around nothing.
[[nodiscard]] sdk::Sphere sphere_around(const sdk::Mesh& mesh);
[[nodiscard]] sdk::Sphere sphere_around(const sdk::SphereMesh& shape);
///@}
/// The smallest sphere about the same centre that holds another one, too.
[[nodiscard]] sdk::Sphere widened(const sdk::Sphere& sphere, const sdk::Sphere& by);

}  // namespace armature::viewer
