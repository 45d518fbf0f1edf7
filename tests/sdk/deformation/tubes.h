#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include <armature/sdk/mesh/measures.h>
#include <armature/sdk/mesh/mesh.h>

#include "tests/sdk/mesh/surfaces.h"

/// Closed tubes and what is asked of meshes that were deformed.
namespace armature::sdk::tubes {

/// A tube about the x axis from -length / 2 to length / 2, with half a ball on either end; the mirror image of itself
/// in x, y and z. `around` is a multiple of 4.
inline Mesh tube(double length, double radius, double swell = 0, int around = 32, int along = 80) {
  const double cap = std::numbers::pi / 2 * radius;
  const double whole = length + 2 * cap;
  Mesh mesh;
  mesh.positions.emplace_back(-length / 2 - radius, 0, 0);
  for (int i = 1; i < along; ++i) {
    const double s = whole * i / along - whole / 2;
    const double beyond = std::max(0.0, std::abs(s) - length / 2) / radius;
    const double x = std::copysign(std::min(std::abs(s), length / 2) + radius * std::sin(beyond), s);
    for (int j = 0; j < around; ++j) {
      const double angle = 2 * std::numbers::pi * j / around;
      const double r = radius * (1 + swell * std::cos(std::numbers::pi * x / radius)) * std::cos(beyond);
      mesh.positions.emplace_back(x, r * std::cos(angle), r * std::sin(angle));
    }
  }
  mesh.positions.emplace_back(length / 2 + radius, 0, 0);
  const auto at = [&](int i, int j) { return static_cast<std::size_t>(1 + (i - 1) * around + j % around); };
  const std::size_t last = mesh.positions.size() - 1;
  for (int j = 0; j < around; ++j) {
    mesh.triangles.push_back(surfaces::triangle(0, at(1, j + 1), at(1, j)));
    mesh.triangles.push_back(surfaces::triangle(last, at(along - 1, j), at(along - 1, j + 1)));
    for (int i = 1; i + 1 < along; ++i) {
      mesh.triangles.push_back(surfaces::triangle(at(i, j), at(i, j + 1), at(i + 1, j + 1)));
      mesh.triangles.push_back(surfaces::triangle(at(i, j), at(i + 1, j + 1), at(i + 1, j)));
    }
  }
  return mesh;
}

/// Of a closed mesh.
inline double volume(const Mesh& mesh) {
  double six = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    six += mesh.corner(FaceId(t), 0).dot(mesh.corner(FaceId(t), 1).cross(mesh.corner(FaceId(t), 2)));
  return six / 6;
}

/// The largest distance between vertices of the same name, as a part of the first one's diagonal.
inline double farthest_apart(const Mesh& a, const Mesh& b) {
  double most = 0;
  for (std::size_t v = 0; v < a.positions.size(); ++v) most = std::max(most, (a.positions[v] - b.positions[v]).norm());
  return most / bounding_box_diagonal(a);
}

}  // namespace armature::sdk::tubes
