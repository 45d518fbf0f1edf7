#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/spheremesh/sphere_mesh.h>

namespace armature::viewer {

/// A city to walk through, made by rule. World frame of NavCamera: metres, x forward and y to the left of a camera that
/// has not moved, z up; the ground is at 0.
struct City {
  sdk::Mesh buildings;                ///< with the ground and the streets; a colour a face
  sdk::SphereMesh trees;              ///< crowns; their trunks are part of `buildings`
  std::vector<Eigen::Vector2d> path;  ///< to be followed, from where the camera starts
};

/// The same city for the same seed.
[[nodiscard]] City make_city(std::uint32_t seed = 1);

/// A band of that width along a path, flat, a little above the ground; `colour` on all of it.
[[nodiscard]] sdk::Mesh make_ribbon(const std::vector<Eigen::Vector2d>& path, double width, const sdk::Colour& colour);

}  // namespace armature::viewer
