#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sdk/distance/sphere_pieces.h"

namespace armature::sdk {

/// A smooth part of the surface of one primitive: a sphere, the cone of an edge, or one of the two facets of a
/// triangle. Its points are named by a parameter: on a sphere the unit normal, on a cone (along the axis, angle, 0), on
/// a facet the weights of its spheres.
struct Patch {
  enum class Kind : std::uint8_t { Sphere, Cone, Facet };
  Kind kind = Kind::Sphere;
  std::uint32_t index = 0;  ///< of the sphere, edge or facet
  double sign = 1;          ///< of a facet: on the side of its n or the other
  std::array<Eigen::Vector3d, 2> across = {
      Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()};  ///< of a cone: right-angled to the axis and each other
  TouchedSpheres spheres = {};
};

/// A point of a patch with the outward normal there.
struct PatchPoint {
  Eigen::Vector3d point;
  Eigen::Vector3d normal;
};

/// Which spheres another one holds, with which they share an edge: nothing of these reaches the surface.
[[nodiscard]] std::vector<bool> held_spheres(const SpherePieces& shape);
/// The patches of one piece that can reach the surface: of an edge also its spheres, but what `held` holds.
[[nodiscard]] std::vector<Patch> patches_of(const SpherePieces& shape, Piece piece, const std::vector<bool>& held);
/// All of them, each once.
[[nodiscard]] std::vector<Patch> patches_of(const SpherePieces& shape);

[[nodiscard]] double area_of(const SpherePieces& shape, const Patch& patch) noexcept;
[[nodiscard]] PatchPoint at(const SpherePieces& shape, const Patch& patch, const Eigen::Vector3d& parameter) noexcept;
/// Weights of the patch's spheres in the sphere that touches there.
[[nodiscard]] Eigen::Vector3d weights_at(const SpherePieces& shape, const Patch& patch,
                                         const Eigen::Vector3d& parameter) noexcept;
/// The parameter half-way between two.
[[nodiscard]] Eigen::Vector3d halfway(const Patch& patch, const Eigen::Vector3d& a, const Eigen::Vector3d& b) noexcept;
/// The parameter at (u, v) in the unit square, such that equal areas there are equal areas here.
[[nodiscard]] Eigen::Vector3d spread(const SpherePieces& shape, const Patch& patch, double u, double v) noexcept;
/// Signed distance to the patch carried on beyond its borders: sphere, cone or plane.
[[nodiscard]] PatchPoint foot_on(const SpherePieces& shape, const Patch& patch, const Eigen::Vector3d& point) noexcept;

/// A triangle of a patch by its corners' parameters.
using PatchTriangle = std::array<Eigen::Vector3d, 3>;
/// Triangles that cover the patch, none much longer than wide.
[[nodiscard]] std::vector<PatchTriangle> cover(const SpherePieces& shape, const Patch& patch);

/// How far the points, and how much the normals, of a triangle of a patch may differ from those at its middle.
struct PatchReach {
  Eigen::Vector3d middle;  ///< parameter
  double distance = 0;
  double turn = 0;  ///< length of the difference of unit normals
};
[[nodiscard]] PatchReach reach_of(const SpherePieces& shape, const Patch& patch, const PatchTriangle& t) noexcept;

}  // namespace armature::sdk
