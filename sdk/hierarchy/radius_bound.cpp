#include "sdk/hierarchy/radius_bound.h"

#include <cmath>

namespace armature::sdk {
namespace {

/// One point's coordinate along every direction, in the units of Extents, unrounded.
using Projection = std::array<float, kDirections>;

Projection project(const Eigen::Vector3d& point) noexcept {
  const Eigen::Vector3f p = point.cast<float>() * 65534.0F;
  const auto& directions = half_sphere_directions();
  Projection along;
  for (std::size_t k = 0; k < kDirections; ++k)
    along[k] = p.x() * directions[k].x() + p.y() * directions[k].y() + p.z() * directions[k].z();
  return along;
}

}  // namespace

const std::array<Eigen::Vector3f, kDirections>& half_sphere_directions() noexcept {
  static const auto directions = [] {
    std::array<Eigen::Vector3f, kDirections> list;
    std::size_t count = 0;
    // The subdivided octahedron's vertices, up to signs: (1,0,0), (1,1,0), (1+sqrt2,1,0), (2,1,1) and permutations.
    const float steep = 1 + std::sqrt(2.0F);
    for (const Eigen::Vector3f& kind :
         {Eigen::Vector3f(1, 0, 0), Eigen::Vector3f(1, 1, 0), Eigen::Vector3f(steep, 1, 0), Eigen::Vector3f(2, 1, 1)}) {
      std::array<float, 3> values{kind.x(), kind.y(), kind.z()};
      std::sort(values.begin(), values.end());
      do {
        for (unsigned signs = 0; signs < 8; ++signs) {
          Eigen::Vector3f d(values[0], values[1], values[2]);
          bool canonical = true;
          bool first = true;
          for (int axis = 0; axis < 3; ++axis) {
            if ((signs >> axis) & 1U) {
              // One of each pair d, -d: the first coordinate that is not zero is positive.
              canonical = canonical && d[axis] != 0 && !first;
              d[axis] = -d[axis];
            }
            if (d[axis] != 0) first = false;
          }
          if (canonical) list[count++] = d.normalized();
        }
      } while (std::next_permutation(values.begin(), values.end()));
    }
    return list;
  }();
  return directions;
}

std::vector<Extents> Extents::of_cells(const std::vector<Eigen::Vector3d>& positions,
                                       const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::vector<Extents> cells(positions.size());
  const auto include = [](Extents& cell, const Projection& point) {
    for (std::size_t k = 0; k < kDirections; ++k) {
      const auto value = static_cast<std::int16_t>(std::lrintf(point[k]));
      const std::size_t hi = k < kBlock ? k : 2 * kBlock;
      const std::size_t lo = k < kBlock ? kBlock + k : 2 * kBlock + 1;
      cell.values_[hi] = std::max(cell.values_[hi], value);
      cell.values_[lo] = std::max(cell.values_[lo], static_cast<std::int16_t>(-value));
    }
  };
  for (const auto& triangle : triangles) {
    std::array<Projection, 3> corner;
    for (std::size_t i = 0; i < 3; ++i) corner[i] = project(positions[triangle[i]]);
    Projection centroid;
    std::array<Projection, 3> middle;  // of the edge from corner i
    for (std::size_t k = 0; k < kDirections; ++k) {
      centroid[k] = (corner[0][k] + corner[1][k] + corner[2][k]) * (1.0F / 3);
      for (std::size_t i = 0; i < 3; ++i) middle[i][k] = 0.5F * (corner[i][k] + corner[(i + 1) % 3][k]);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      Extents& cell = cells[triangle[i]];
      for (const Projection* point : {&corner[i], &middle[i], &middle[(i + 2) % 3], &centroid}) include(cell, *point);
    }
  }
  return cells;
}

}  // namespace armature::sdk
