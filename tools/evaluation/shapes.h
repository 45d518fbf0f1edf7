#pragma once

#include <cstdint>

#include <armature/sdk/mesh/mesh.h>

namespace armature::tools {

/// A sphere of `radius` about the origin: an icosahedron whose faces are cut into four `rounds` times.
[[nodiscard]] sdk::Mesh icosphere(int rounds, double radius = 1);

/// Two concentric spheres, the inner one inside out: a hollow ball (thesis, Figure 4.14).
[[nodiscard]] sdk::Mesh hollow_ball(int rounds, double inner_radius);

/// A closed blob with eight arms of different lengths, and ripples: a shape with parts, for want of a model.
[[nodiscard]] sdk::Mesh creature(int rounds);

/// A closed tube of radius 1 about the x axis, its middle at the origin, `length` long between two half balls. `around`
/// vertices stand on each ring, rings as far apart as these, and each turned against the last: by `twist` radians a
/// length of 1.
[[nodiscard]] sdk::Mesh straight_tube(double length, int around, double twist = 0);

/// Every face cut into four at the midpoints of its edges; the surface stays what it is.
[[nodiscard]] sdk::Mesh subdivided(const sdk::Mesh& mesh);

/// Every vertex moved in a direction of its own by up to `percent` of the bounding box's diagonal (Figure 4.13).
[[nodiscard]] sdk::Mesh with_noise(const sdk::Mesh& mesh, double percent, std::uint32_t seed);

/// The faces on one side of the plane through the middle of the box's longest side, left open ("Half bear").
[[nodiscard]] sdk::Mesh half_of(const sdk::Mesh& mesh);

}  // namespace armature::tools
