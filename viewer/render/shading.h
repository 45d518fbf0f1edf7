#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/spheremesh/primitives.h>

namespace armature::viewer {

/// The normals with which the corners of each face are shaded, by FaceId: the mean over the faces around the vertex
/// that turn from this one by no more than `crease_rad`, weighted by their angles there. Faces without area get the
/// normals of their neighbours, or zero where there are none. Any mesh will do, non-manifold ones too.
[[nodiscard]] std::vector<std::array<Eigen::Vector3d, 3>> corner_normals(const sdk::Mesh& mesh, double crease_rad);

/// One of the two triangles that lie on three spheres at once: a flat side of their convex hull.
struct TangentTriangle {
  std::array<Eigen::Vector3d, 3> corners;  // in the spheres' order; clockwise around the normal on one of the two sides
  Eigen::Vector3d normal;                  // outward, unit length
};

/// Both flat sides of the convex hull of three spheres: with n the normal of the plane through the centres and g the
/// gradient of the radius in it, their normals are +-sqrt(1 - |g|^2) n - g (thesis, section 4.3). None where |g| >= 1
/// or where the centres lie on a line: the hull is then that of its edges.
[[nodiscard]] std::optional<std::array<TangentTriangle, 2>> tangent_triangles(
    const std::array<sdk::Sphere, 3>& spheres);

}  // namespace armature::viewer
