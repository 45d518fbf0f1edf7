#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/mesh/mesh.h>

#include "sdk/spheremesh/union_gauge.h"

namespace armature::sdk {

/// Points of an input surface, as many to an area everywhere, in an order that keeps near ones together.
struct SurfaceSamples {
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3d> normals;  ///< of unit length
  std::vector<FaceId> faces;
};

/// `count` samples of a mesh in the unit frame, one in each of as many strips of the same area; the same on every run.
/// None for a mesh without area.
[[nodiscard]] SurfaceSamples sample_input(const Mesh& mesh, std::size_t count);

/// Which pieces are meant, by their corners.
using PieceFilter = std::function<bool(const Corners&)>;

/// A point of a union's boundary, or of one of its pieces.
struct UnionSample {
  Eigen::Vector3d point;
  Eigen::Vector3d normal;  ///< outward, of unit length
  Corners corners{};       ///< of the interpolated sphere that it lies on
  std::array<double, 3> weights{};
  std::uint32_t piece = kSphere;  ///< as UnionTouch names it, or:
  double share = 1;               ///< of a sample's area: pieces too small for many samples get some nevertheless

  static constexpr std::uint32_t kSphere = 0xFFFFFFFF;  ///< part of a sphere at a corner
};

/// Samples of the boundary of a union, cavities included, `density` to an area, in an order that keeps near ones
/// together; of the pieces that `only` picks, if it is given.
[[nodiscard]] std::vector<UnionSample> sample_union(const UnionGauge& gauge, double density,
                                                    const PieceFilter& only = {});

}  // namespace armature::sdk
