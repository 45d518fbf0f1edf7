#pragma once

#include <optional>

#include <armature/sdk/mesh/adjacency.h>
#include <armature/sdk/mesh/mesh.h>

namespace armature::sdk {

/// The same mesh without its noise; nothing where it has none.
///
/// With d the way of a vertex from the middle of its neighbours, a shape bends alike at neighbours, so that their d
/// agree; noise makes them disagree. While the sum of d_i . d_j over all edges is negative, every vertex goes half of d
/// towards the middle.
[[nodiscard]] std::optional<Mesh> without_noise(const Mesh& mesh, const Adjacency& adjacency);

}  // namespace armature::sdk
