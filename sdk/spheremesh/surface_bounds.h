#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/distance/sphere_mesh_tree.h>
#include <armature/sdk/mesh/mesh.h>

namespace armature::sdk {

/// Which side of a union a surface should not be on.
enum class Side { Outside, Inside };

/// A part of a surface that is, or may be, on the wrong side of a union.
struct Trespass {
  double by = 0;  ///< no point of the part is farther on that side
  TouchedSpheres spheres{};
};

/// By face that is not found to be on the right side all over: the worst of its parts. Parts smaller than `size` are
/// not divided further.
[[nodiscard]] std::vector<Trespass> trespasses(const Mesh& mesh, const SphereMesh& shape, Side side, double size);

/// Makes radii larger until no part of the surface is outside the union by more than rounding: the union then encloses
/// the mesh. `size` is the smallest part of the surface that is looked at.
void enclose(const Mesh& mesh, SphereMesh& shape, const std::vector<bool>& fixed, double size);

/// Makes radii smaller until no part of the surface is within the union by more than `size`, and takes away simplices
/// that cannot be made small enough. Spheres outside the mesh become points on it.
void retreat(const Mesh& mesh, SphereMesh& shape, const std::vector<bool>& fixed, double size);

}  // namespace armature::sdk
