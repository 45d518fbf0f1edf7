#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/mesh/mesh.h>

namespace armature::sdk {

/// A small piece of a surface.
struct SurfaceSample {
  Eigen::Vector3d point;
  Eigen::Vector3d normal;  ///< of its face
  double area;
  FaceId face;
};

/// Faces cut into pieces of about `area`, each face into k^2 equal triangles; one piece for a smaller face, none for
/// one without area. What is measured with them depends little on how the surface is cut into triangles, and not at all
/// on how it is turned. At most 64^2 pieces a face.
[[nodiscard]] std::vector<SurfaceSample> samples_of(const Mesh& mesh, std::span<const FaceId> faces, double area);

}  // namespace armature::sdk
