#include "sdk/spheremesh/outer_space.h"

#include <algorithm>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

constexpr int kBlock = 8;        // cells along a block that is looked at as a whole
constexpr double kThick = 0.55;  // in cells; above 1/2, so that not even a sheet lets the flood through
constexpr double kHalfDiagonal = 0.8660254037844387;

}  // namespace

OuterSpace::OuterSpace(const UnionGauge& gauge, int cells) : wanted_cells_(cells), seen_(gauge) {
  look(gauge);
}

void OuterSpace::follow(const UnionGauge& gauge) {
  if (gauge == seen_) return;
  seen_ = gauge;
  look(gauge);
}

void OuterSpace::look(const UnionGauge& gauge) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vector3d lower = Vector3d::Constant(kInfinity);
  Vector3d upper = -lower;
  for (const Sphere& s : gauge.spheres()) {
    lower = lower.cwiseMin(s.centre - Vector3d::Constant(s.radius));
    upper = upper.cwiseMax(s.centre + Vector3d::Constant(s.radius));
  }
  size_ = std::max((upper - lower).maxCoeff() / wanted_cells_, 1e-9);
  constexpr int kMargin = 3;
  lower_ = lower - Vector3d::Constant(kMargin * size_);
  std::size_t count = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    extent_[k] = static_cast<int>(std::ceil((upper[axis] - lower[axis]) / size_)) + 2 * kMargin;
    count *= static_cast<std::size_t>(extent_[k]);
  }
  cells_.assign(count, Cell::Free);

  const NearbyPieces all = gauge.all();
  tbb::parallel_for(0, (extent_[2] + kBlock - 1) / kBlock, [&](int z) {
    for (int y = 0; y < extent_[1]; y += kBlock)
      for (int x = 0; x < extent_[0]; x += kBlock) take(gauge, all, {x, y, z * kBlock}, kBlock);
  });
  flood();
}

void OuterSpace::take(const UnionGauge& gauge, const NearbyPieces& pieces, const std::array<int, 3>& at, int width) {
  for (std::size_t k = 0; k < 3; ++k)
    if (at[k] >= extent_[k]) return;
  const Vector3d middle = lower_ + size_ * (Vector3d(at[0], at[1], at[2]) + Vector3d::Constant(0.5 * width));
  const double thick = kThick * size_;
  const double reach = kHalfDiagonal * (width - 1) * size_;  // to the middle of the farthest cell
  const double distance = gauge.distance(pieces, middle, thick + reach, thick - reach) - thick;
  if (distance >= reach) return;
  if (width == 1 || distance < -reach) {
    std::array<int, 3> end{};
    for (std::size_t k = 0; k < 3; ++k) end[k] = std::min(extent_[k], at[k] + width);
    for (int z = at[2]; z < end[2]; ++z)
      for (int y = at[1]; y < end[1]; ++y)
        std::fill_n(cells_.begin() + static_cast<std::ptrdiff_t>(index({at[0], y, z})), end[0] - at[0], Cell::Taken);
    return;
  }
  NearbyPieces near;
  if (width >= kBlock / 2) gauge.near(pieces, middle, reach, thick, near);
  const int half = width / 2;
  for (int k = 0; k < 8; ++k)
    take(gauge, width >= kBlock / 2 ? near : pieces,
         {at[0] + (k & 1) * half, at[1] + (k >> 1 & 1) * half, at[2] + (k >> 2) * half}, half);
}

void OuterSpace::flood() {
  // The margin is free and ends in a layer that is not entered, so that no step leaves the grid.
  const auto row = static_cast<std::size_t>(extent_[0]);
  const std::size_t layer = row * static_cast<std::size_t>(extent_[1]);
  for (int z = 0; z < extent_[2]; ++z)
    for (int y = 0; y < extent_[1]; ++y) {
      const bool face = z == 0 || y == 0 || z + 1 == extent_[2] || y + 1 == extent_[1];
      const auto begin = cells_.begin() + static_cast<std::ptrdiff_t>(index({0, y, z}));
      if (face) std::fill_n(begin, row, Cell::Outer);
      begin[0] = begin[extent_[0] - 1] = Cell::Outer;
    }
  // By stretches of rows: each is filled at once, and its neighbours looked through for others.
  std::vector<std::array<std::size_t, 2>> open;
  const auto fill = [&](std::size_t at) {
    std::size_t first = at;
    std::size_t end = at + 1;
    while (cells_[first - 1] == Cell::Free) --first;
    while (cells_[end] == Cell::Free) ++end;
    std::fill(cells_.begin() + static_cast<std::ptrdiff_t>(first), cells_.begin() + static_cast<std::ptrdiff_t>(end),
              Cell::Outer);
    open.push_back({first, end});
  };
  fill(index({1, 1, 1}));
  while (!open.empty()) {
    const auto [first, end] = open.back();
    open.pop_back();
    for (std::size_t at = first; at < end; ++at)
      for (const std::size_t neighbour : {at - row, at + row, at - layer, at + layer})
        if (cells_[neighbour] == Cell::Free) fill(neighbour);
  }
}

bool OuterSpace::outer(const Vector3d& point) const noexcept {
  std::array<int, 3> at{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    const double cell = std::floor((point[axis] - lower_[axis]) / size_);
    if (!(cell >= 0 && cell < extent_[k])) return true;
    at[k] = static_cast<int>(cell);
  }
  return cells_[index(at)] == Cell::Outer;
}

bool OuterSpace::sees(const Vector3d& point, const Vector3d& normal) const noexcept {
  // Along the normal only, at first: to the sides one might look through a thin wall.
  for (const double cells : {1.2, 1.7, 0.8, 2.3})
    if (outer(point + cells * size_ * normal)) return true;
  const Vector3d ahead = point + 1.7 * size_ * normal;
  for (Eigen::Index k = 0; k < 3; ++k)
    for (const double side : {-0.7, 0.7})
      if (outer(ahead + side * size_ * Vector3d::Unit(k))) return true;
  return false;
}

}  // namespace armature::sdk
