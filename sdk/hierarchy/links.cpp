#include "sdk/hierarchy/links.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

namespace armature::sdk {
namespace {

using Pair = CollapseComplex::Pair;

/// The place of a point of the unit cube about the origin along a curve that fills it.
std::uint64_t morton_code(const Eigen::Vector3d& point) noexcept {
  constexpr int kBits = 21;
  std::uint64_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double along = std::clamp(point[axis] + 0.5, 0.0, 1.0) * ((1 << kBits) - 1);
    const auto cell = static_cast<std::uint64_t>(along);
    for (int bit = 0; bit < kBits; ++bit) code |= (cell >> bit & 1U) << (3 * bit + axis);
  }
  return code;
}

/// Indices of the points, in the order of that curve.
std::vector<std::uint32_t> morton_order(std::span<const Eigen::Vector3d> points) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> coded;
  coded.reserve(points.size());
  for (std::uint32_t k = 0; k < points.size(); ++k) coded.emplace_back(morton_code(points[k]), k);
  std::sort(coded.begin(), coded.end());
  std::vector<std::uint32_t> order;
  order.reserve(points.size());
  for (const auto& [code, k] : coded) order.push_back(k);
  return order;
}

}  // namespace

std::vector<Pair> links_of_loose_vertices(const NormalisedShape& shape, std::span<const std::uint32_t> labels) {
  std::vector<bool> loose(shape.positions.size(), true);
  for (const auto& triangle : shape.triangles)
    for (const auto corner : triangle) loose[corner] = false;
  if (std::find(loose.begin(), loose.end(), true) == loose.end()) return {};

  // The nearest among a few on either side along the curve is near enough for what weighs nothing.
  constexpr int kReach = 8;
  const auto order = morton_order(shape.positions);
  std::vector<Pair> links;
  std::vector<std::vector<std::uint32_t>> candidates(shape.positions.size());
  const auto sweep = [&](auto first, auto last) {
    std::vector<std::uint32_t> recent;
    for (auto at = first; at != last; ++at) {
      if (!loose[*at]) {
        recent.push_back(*at);
        continue;
      }
      int found = 0;
      for (auto k = recent.rbegin(); k != recent.rend() && found < kReach; ++k, ++found)
        if (labels.empty() || labels[*k] == labels[*at]) candidates[*at].push_back(*k);
    }
  };
  sweep(order.begin(), order.end());
  sweep(order.rbegin(), order.rend());
  for (std::uint32_t v = 0; v < candidates.size(); ++v) {
    if (candidates[v].empty()) continue;
    const auto nearest =
        *std::min_element(candidates[v].begin(), candidates[v].end(), [&](std::uint32_t a, std::uint32_t b) {
          return (shape.positions[a] - shape.positions[v]).squaredNorm() <
                 (shape.positions[b] - shape.positions[v]).squaredNorm();
        });
    links.push_back({nearest, v});
  }
  return links;
}

std::vector<Pair> links_through_the_solid(const NormalisedShape& shape, double reach) {
  if (!(reach > 0)) return {};
  std::vector<Eigen::Vector3d> normals(shape.positions.size(), Eigen::Vector3d::Zero());
  for (const auto& [a, b, c] : shape.triangles) {
    const auto& p = shape.positions;
    const Eigen::Vector3d cross = (p[b] - p[a]).cross(p[c] - p[a]);
    for (const auto v : {a, b, c}) normals[v] += cross;
  }

  // Vertices by cell and octant, the first of each.
  constexpr int kCellsPerReach = 3;
  const double side = std::max(reach / kCellsPerReach, 1e-4);
  const int around = static_cast<int>(std::ceil(std::min(reach, 1.0) / side));
  const auto cell_of = [&](const Eigen::Vector3d& p) -> std::array<int, 3> {
    return {static_cast<int>((p.x() + 0.5) / side), static_cast<int>((p.y() + 0.5) / side),
            static_cast<int>((p.z() + 0.5) / side)};
  };
  const auto key_of = [](const std::array<int, 3>& cell, unsigned octant) {
    std::uint64_t key = 0;
    for (const int c : cell) key = key << 20 | (static_cast<std::uint64_t>(c + 8) & 0xFFFFFU);
    return key << 3 | octant;
  };
  std::vector<std::pair<std::uint64_t, std::uint32_t>> sites;
  for (std::uint32_t v = 0; v < shape.positions.size(); ++v) {
    if (!(normals[v].squaredNorm() > 0)) continue;
    const unsigned octant =
        (normals[v].x() < 0 ? 1U : 0U) | (normals[v].y() < 0 ? 2U : 0U) | (normals[v].z() < 0 ? 4U : 0U);
    sites.emplace_back(key_of(cell_of(shape.positions[v]), octant), v);
  }
  std::sort(sites.begin(), sites.end());
  sites.erase(std::unique(sites.begin(), sites.end(), [](const auto& x, const auto& y) { return x.first == y.first; }),
              sites.end());

  constexpr std::size_t kNearest = 4;
  std::vector<Pair> links;
  std::vector<std::pair<double, std::uint32_t>> near;
  for (const auto& [key, a] : sites) {
    near.clear();
    const Eigen::Vector3d& p = shape.positions[a];
    const auto home = cell_of(p);
    for (int x = -around; x <= around; ++x)
      for (int y = -around; y <= around; ++y) {
        // One run of keys for a row of cells.
        const std::array<int, 3> from{home[0] + x, home[1] + y, home[2] - around};
        const std::array<int, 3> to{home[0] + x, home[1] + y, home[2] + around};
        if (from[0] < -8 || from[1] < -8 || from[2] < -8) continue;
        auto at = std::lower_bound(sites.begin(), sites.end(), std::pair{key_of(from, 0), std::uint32_t{0}});
        for (; at != sites.end() && at->first <= key_of(to, 7); ++at) {
          const std::uint32_t b = at->second;
          const Eigen::Vector3d d = shape.positions[b] - p;
          if (a == b || d.squaredNorm() >= reach * reach) continue;
          if (normals[a].dot(d) > 0 || normals[b].dot(d) < 0 || normals[a].dot(normals[b]) >= 0) continue;
          near.emplace_back(d.squaredNorm(), b);
        }
      }
    std::sort(near.begin(), near.end());
    if (near.size() > kNearest) near.resize(kNearest);
    for (const auto& [distance, b] : near) links.push_back({std::min(a, b), std::max(a, b)});
  }
  std::sort(links.begin(), links.end());
  links.erase(std::unique(links.begin(), links.end()), links.end());
  return links;
}

std::vector<Pair> links_between_components(std::span<const std::uint32_t> slots,
                                           std::span<const Eigen::Vector3d> centres) {
  constexpr std::size_t kAllPairs = 256;
  constexpr std::size_t kAlongCurve = 8;
  const bool all = slots.size() <= kAllPairs;
  const auto order = morton_order(centres);
  std::vector<Pair> links;
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < (all ? order.size() : std::min(order.size(), i + 1 + kAlongCurve)); ++j)
      links.push_back({slots[order[i]], slots[order[j]]});
  return links;
}

}  // namespace armature::sdk
