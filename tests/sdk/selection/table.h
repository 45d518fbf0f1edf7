#pragma once

#include <algorithm>
#include <iterator>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/mesh/measures.h>
#include <armature/sdk/mesh/mesh.h>

#include "tests/sdk/mesh/surfaces.h"

/// Tables of side 2 with something on them, and regions of theirs.
namespace armature::sdk::table {

/// A round block in the middle: radius 0.4, height 0.2, steep but not vertical.
inline Mesh table_with_a_block() {
  return surfaces::over({100, 100, false, false, 0}, [](double i, double j) {
    const Eigen::Vector3d p(2 * i - 1, 2 * j - 1, 0);
    return Eigen::Vector3d(p.x(), p.y(), 0.2 * std::clamp((0.45 - p.norm()) / 0.05, 0.0, 1.0));
  });
}

inline Eigen::Vector3d middle(const Mesh& mesh, FaceId face) {
  return (mesh.corner(face, 0) + mesh.corner(face, 1) + mesh.corner(face, 2)) / 3;
}

/// The faces whose middles lie within a radius of a point, seen from above.
inline std::vector<FaceId> faces_within(const Mesh& mesh, double radius,
                                        const Eigen::Vector2d& centre = Eigen::Vector2d::Zero()) {
  std::vector<FaceId> faces;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    if ((table::middle(mesh, FaceId(f)).head<2>() - centre).norm() < radius) faces.emplace_back(f);
  return faces;
}

/// Intersection over union, by area.
inline double overlap(const Mesh& mesh, const std::vector<FaceId>& a, const std::vector<FaceId>& b) {
  const auto area = [&](const std::vector<FaceId>& faces) {
    double sum = 0;
    for (const FaceId face : faces) sum += area_vector(mesh, face).norm();
    return sum;
  };
  std::vector<FaceId> both;
  std::ranges::set_intersection(a, b, std::back_inserter(both));
  return area(both) / (area(a) + area(b) - area(both));
}

}  // namespace armature::sdk::table
