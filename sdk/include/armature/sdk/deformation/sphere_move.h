#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/deformation/skinning.h>
#include <armature/sdk/error.h>
#include <armature/sdk/mesh/ids.h>
#include <armature/sdk/spheremesh/sphere_mesh.h>

namespace armature::sdk {

/// What a user does to some spheres of a level at once: x goes to about + R (scale (x - about)) + translate. An edge or
/// a triangle is moved by its two or three spheres.
struct SphereMove {
  std::vector<SphereId> spheres = {};                   ///< of the level, in any order; each moves once
  Eigen::Vector3d translate = Eigen::Vector3d::Zero();  ///< in lengths of the model
  Eigen::Vector3d rotate = Eigen::Vector3d::Zero();     ///< the axis, as long as the angle in radians
  std::optional<Eigen::Vector3d> about = {};            ///< the mean of the spheres' centres if left out
  double scale = 1;                                     ///< of distances and radii; positive
  std::optional<double> radius = {};                    ///< what each sphere's radius becomes: the shape swells there
};

/// What is wrong with a move of a level of so many spheres: names the field, and what was expected.
[[nodiscard]] Expected<void> check(const SphereMove& move, std::size_t spheres);

/// Spheres that have not moved yet.
[[nodiscard]] std::vector<SphereMotion> at_rest(std::span<const Sphere> spheres);

/// Moves spheres from where they are now. The move must be one that `check()` finds nothing wrong with. Spheres marked
/// in `held`, [spheres] or empty, stay.
void move_spheres(const SphereMove& move, std::span<SphereMotion> motions, const std::vector<bool>& held = {});

}  // namespace armature::sdk
