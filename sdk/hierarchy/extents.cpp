#include "sdk/hierarchy/extents.h"

#include <cmath>
#include <numbers>

namespace armature::sdk {
namespace {

/// One point's coordinate along every direction, in the units of Extents, unrounded.
using Projection = std::array<float, kDirections>;

Projection project(const Eigen::Vector3d& point) noexcept {
  // Each coordinate of all directions in a row, so that the loop compiles to vectors.
  static const auto rows = [] {
    std::array<Projection, 3> list;
    for (std::size_t k = 0; k < kDirections; ++k)
      for (std::size_t axis = 0; axis < 3; ++axis)
        list[axis][k] = half_sphere_directions()[k][static_cast<Eigen::Index>(axis)];
    return list;
  }();
  const Eigen::Vector3f p = point.cast<float>() * 65534.0F;
  Projection along;
  for (std::size_t k = 0; k < kDirections; ++k) along[k] = p.x() * rows[0][k] + p.y() * rows[1][k] + p.z() * rows[2][k];
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

Extents Extents::of_point(const std::array<float, kDirections>& along) noexcept {
  std::array<std::int16_t, kDirections> rounded;
  // Adding a positive offset makes truncation round, and leaves a loop that compiles to vectors.
  for (std::size_t k = 0; k < kDirections; ++k)
    rounded[k] = static_cast<std::int16_t>(static_cast<int>(along[k] + 32768.5F) - 32768);
  Extents point;
  for (std::size_t k = 0; k < kBlock; ++k) {
    point.values_[k] = rounded[k];
    point.values_[kBlock + k] = static_cast<std::int16_t>(-rounded[k]);
  }
  point.values_[2 * kBlock] = rounded[kBlock];
  point.values_[2 * kBlock + 1] = static_cast<std::int16_t>(-rounded[kBlock]);
  return point;
}

std::vector<Extents> Extents::of_cells(const std::vector<Eigen::Vector3d>& positions,
                                       const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::vector<Extents> cells(positions.size());
  for (const auto& triangle : triangles) {
    std::array<Projection, 3> corner;
    for (std::size_t i = 0; i < 3; ++i) corner[i] = project(positions[triangle[i]]);
    Projection between;
    for (std::size_t k = 0; k < kDirections; ++k)
      between[k] = (corner[0][k] + corner[1][k] + corner[2][k]) * (1.0F / 3);
    const Extents inner = of_point(between);
    std::array<Extents, 3> sides;  // the middle of the edge from corner i
    for (std::size_t i = 0; i < 3; ++i) {
      const Projection& from = corner[i];
      const Projection& to = corner[(i + 1) % 3];
      for (std::size_t k = 0; k < kDirections; ++k) between[k] = 0.5F * (from[k] + to[k]);
      sides[i] = of_point(between);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      Extents& cell = cells[triangle[i]];
      cell |= inner;
      cell |= sides[i];
      cell |= sides[(i + 2) % 3];
      cell |= of_point(corner[i]);
    }
  }
  return cells;
}

std::vector<Extents> Extents::of_discs(const std::vector<Eigen::Vector3d>& positions,
                                       const std::vector<Eigen::Vector3d>& normals, const std::vector<double>& areas) {
  std::vector<Extents> discs(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!(areas[i] > 0)) continue;
    const Projection middle = project(positions[i]);
    const auto radius = static_cast<float>(std::sqrt(areas[i] / std::numbers::pi));
    const Eigen::Vector3f normal = normals[i].cast<float>();
    Projection low, high;
    for (std::size_t k = 0; k < kDirections; ++k) {
      const float steep = normal.dot(half_sphere_directions()[k]);
      const float reach = radius * std::sqrt(std::max(0.0F, 1 - steep * steep)) * 65534.0F;
      // A disc may reach beyond the box.
      low[k] = std::max(middle[k] - reach, -32767.0F);
      high[k] = std::min(middle[k] + reach, 32767.0F);
    }
    discs[i] = of_point(low);
    discs[i] |= of_point(high);
  }
  return discs;
}

}  // namespace armature::sdk
