#pragma once

#include <cstddef>
#include <vector>

#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/spheremesh/sphere_mesh.h>

namespace armature::viewer {

/// A mesh to look at while something moves.
struct CoarseMesh {
  sdk::Mesh mesh;
  std::vector<sdk::FaceId> source;  ///< by FaceId of the coarse mesh: which face of the mesh it was
};

/// Joins the vertices in each cell of a grid of `cells` along the longest side of the bounding box, at their mean
/// (Rossignac and Borrel 1993). Faces within one or two cells go, and of several between the same three all but one.
/// Takes time n log n.
[[nodiscard]] CoarseMesh coarse_mesh(const sdk::Mesh& mesh, std::size_t cells);

/// The flat parts of a sphere-mesh's surface: of every triangle the two facets that touch its three spheres, with
/// corners of their own, facing outward. Of a fine level they are next to all of it.
[[nodiscard]] sdk::Mesh facets(const sdk::SphereMesh& shape);

}  // namespace armature::viewer
