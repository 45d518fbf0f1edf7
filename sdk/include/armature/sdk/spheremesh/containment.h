#pragma once

#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/spheremesh/sphere_mesh.h>

namespace armature::sdk {

/// How the surface of a mesh lies to a sphere-mesh, as bounds over all of the surface and not only samples of it, in
/// units of the mesh. A face within one interpolated simplex is within the union since that is convex; others are
/// quartered until a point's distance decides.
struct Containment {
  /// No point of the surface lies farther than this outside the union. 0: the union encloses the mesh.
  double uncovered = 0;
  /// No point of the surface lies deeper than this within the union. 0: the union does not cross the surface.
  double crossed = 0;
};

/// Bounds to within `tolerance`, a fraction of the mesh's bounding box diagonal: what is found smaller than that on a
/// part of the surface of this size counts as it is bounded there.
[[nodiscard]] Containment containment(const Mesh& mesh, const SphereMesh& shape, double tolerance = 5e-4);

}  // namespace armature::sdk
