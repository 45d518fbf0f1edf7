#pragma once

#include <cstdint>
#include <vector>

#include <armature/sdk/spheremesh/sphere_mesh.h>

namespace armature::sdk {

/// Edits of a sphere-mesh's connectivity. All return the sphere-mesh in order: ids sorted, each simplex once, edges of
/// triangles not listed.

/// Both spheres made one, in the place of `keep`; the last sphere takes the place of `drop`.
[[nodiscard]] SphereMesh collapsed(const SphereMesh& shape, SphereId keep, SphereId drop, const Sphere& sphere);
/// A new sphere, the last one, in the middle of the edge a-b: every simplex at the edge becomes two.
[[nodiscard]] SphereMesh edge_split(const SphereMesh& shape, SphereId a, SphereId b, const Sphere& sphere);
/// A new sphere, the last one, within a triangle, which becomes three.
[[nodiscard]] SphereMesh triangle_split(const SphereMesh& shape, const SphereTriple& triangle, const Sphere& sphere);
/// A new sphere, the last one, joined to others: to one by an edge, to two by a triangle, to three by three triangles.
[[nodiscard]] SphereMesh attached(const SphereMesh& shape, std::vector<SphereId> to, const Sphere& sphere);
/// Without a triangle; its edges stay.
[[nodiscard]] SphereMesh without(const SphereMesh& shape, const SphereTriple& triangle);
/// Without a wire edge.
[[nodiscard]] SphereMesh without(const SphereMesh& shape, const SpherePair& edge);
/// With another triangle, or edge.
[[nodiscard]] SphereMesh with(const SphereMesh& shape, const SphereTriple& triangle);
[[nodiscard]] SphereMesh with(const SphereMesh& shape, const SpherePair& edge);
/// Instead of the triangles a-b-c and a-b-d the triangles a-c-d and b-c-d.
[[nodiscard]] SphereMesh flipped(const SphereMesh& shape, SphereId a, SphereId b, SphereId c, SphereId d);

/// A part of a sphere-mesh, with ids of its own.
struct ShapePart {
  SphereMesh shape;
  std::vector<SphereId> whole;  ///< by sphere of the part: the one of the whole

  /// The part's id of a sphere of the whole, which must be in it.
  [[nodiscard]] SphereId part_id(SphereId of_whole) const;
};

/// Which spheres share a simplex, by SphereId; sorted.
[[nodiscard]] std::vector<std::vector<SphereId>> neighbours(const SphereMesh& shape);

/// Finds the parts around spheres in time that does not grow with the whole.
class Stars {
 public:
  explicit Stars(const SphereMesh& shape);

  [[nodiscard]] const std::vector<SphereId>& neighbours(SphereId sphere) const { return neighbours_[sphere.index()]; }
  /// All simplices with a corner among these spheres or their neighbours.
  [[nodiscard]] ShapePart around(const std::vector<SphereId>& centres) const;

 private:
  const SphereMesh& shape_;
  std::vector<std::vector<SphereId>> neighbours_;
  std::vector<std::vector<std::uint32_t>> edges_, triangles_;  // by sphere
};

}  // namespace armature::sdk
