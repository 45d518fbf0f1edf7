#pragma once

#include <array>
#include <vector>

#include <armature/sdk/mesh/ids.h>
#include <armature/sdk/spheremesh/primitives.h>

namespace armature::sdk {

/// The two spheres of an edge, the smaller id first.
using SpherePair = std::array<SphereId, 2>;
/// The three spheres of a triangle, in ascending order.
using SphereTriple = std::array<SphereId, 3>;

/// A shape as a few interpolated spheres (thesis, section 4.3): the union of the spheres, of the convex hulls of the
/// pairs named by `edges` and of the triples named by `triangles`. Any length unit, any frame.
struct SphereMesh {
  std::vector<Sphere> spheres = {};          ///< by SphereId; radii are not negative
  std::vector<SpherePair> edges = {};        ///< wire edges: those on no triangle; sorted, each once
  std::vector<SphereTriple> triangles = {};  ///< sorted, each once

  /// The sphere of that name.
  [[nodiscard]] const Sphere& sphere(SphereId id) const noexcept { return spheres[id.index()]; }
};

}  // namespace armature::sdk
