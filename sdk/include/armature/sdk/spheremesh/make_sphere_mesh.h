#pragma once

#include <span>
#include <vector>

#include <armature/sdk/spheremesh/sphere_mesh.h>

namespace armature::sdk {

/// A sphere-mesh out of edges and triangles in any order: ids sorted within and among themselves, each pair and triple
/// once, an edge that names one sphere twice left out, a triangle that does so made an edge (or left out, where it
/// names one alone), and of the edges only those kept that lie on no triangle. Every id names one of `spheres`.
[[nodiscard]] SphereMesh make_sphere_mesh(std::vector<Sphere> spheres, std::span<const SpherePair> edges,
                                          std::span<const SphereTriple> triangles);

}  // namespace armature::sdk
