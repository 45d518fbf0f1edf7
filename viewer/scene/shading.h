#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/mesh/mesh.h>

namespace armature::viewer {

/// The normals with which the corners of each face are shaded, by FaceId: the mean over the faces around the vertex
/// that turn from this one by no more than `crease_rad`, weighted by their angles there. Faces without area get the
/// normals of their neighbours, or zero where there are none. Any mesh will do, non-manifold ones too.
[[nodiscard]] std::vector<std::array<Eigen::Vector3d, 3>> corner_normals(const sdk::Mesh& mesh, double crease_rad);

}  // namespace armature::viewer
