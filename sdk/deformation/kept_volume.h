#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/deformation/skinning.h>
#include <armature/sdk/deformation/sphere_weights.h>
#include <armature/sdk/mesh/mesh.h>

namespace armature::sdk {

/// Whether a mesh has no border: each edge is walked as often one way as the other, so that its triangles enclose a
/// volume wherever the origin is.
[[nodiscard]] bool is_closed(const Mesh& mesh);
/// Six times the volume that the triangles of a closed mesh enclose with their corners there. The same bits on any
/// number of threads.
[[nodiscard]] double six_volumes(const Mesh& mesh, std::span<const Eigen::Vector3d> positions);

/// [V]: the normals of a mesh, each as long as the radius of the spheres there, in the mean.
[[nodiscard]] std::vector<Eigen::Vector3d> outward_by_radius(const Mesh& mesh, const SkinWeights& weights,
                                                             std::span<const Sphere> spheres);

/// Gives a closed mesh the volume back that blended turns have given or taken (after von Funck, Theisel, Seidel 2008):
/// where turns disagree, the surface moves outward or inward, more where they disagree more and where spheres are
/// larger, by at most half of their radius; what turns as a whole stays. `wanted` is the six_volumes() of the mesh at
/// rest; `positions` and `directions` are what skin_with_directions() has made of it and of its outward_by_radius(),
/// `most_of_radius` what it has returned. The same bits on any number of threads.
void keep_volume(const Mesh& mesh, std::span<const Eigen::Vector3d> directions, double most_of_radius, double wanted,
                 std::span<Eigen::Vector3d> positions);

}  // namespace armature::sdk
