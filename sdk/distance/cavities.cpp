#include "sdk/distance/cavities.h"

#include <algorithm>
#include <cmath>

namespace armature::sdk {

using Eigen::Vector3d;

Cavities::Cavities(const SphereMeshTree& tree, int resolution) {
  const auto [lower, upper] = tree.bounds();
  const double longest = (upper - lower).maxCoeff();
  if (!(longest > 0)) return;
  spacing_ = longest / resolution;
  // A layer of cells around the box, so that what is outside hangs together.
  origin_ = lower.array() - spacing_;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    count_[axis] = static_cast<int>(std::ceil((upper[a] - lower[a]) / spacing_)) + 2;
  }
  cells_.assign(static_cast<std::size_t>(count_[0]) * static_cast<std::size_t>(count_[1]) *
                    static_cast<std::size_t>(count_[2]),
                Cell::Free);
  int size = 1;
  while (size < std::max({count_[0], count_[1], count_[2]})) size *= 2;
  classify(tree, {0, 0, 0}, size);
  flood();
  any_ = std::find(cells_.begin(), cells_.end(), Cell::Free) != cells_.end();
  if (!any_) cells_.clear();
}

Vector3d Cavities::middle(const std::array<int, 3>& cell) const noexcept {
  return origin_ + spacing_ * Vector3d(cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5);
}

void Cavities::classify(const SphereMeshTree& tree, const std::array<int, 3>& first, int size) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (first[axis] >= count_[axis]) return;
  const Vector3d centre = origin_ + spacing_ * Vector3d(first[0] + size / 2.0, first[1] + size / 2.0,
                                                        first[2] + size / 2.0);
  const double reach = std::sqrt(3.0) / 2 * (size - 1) * spacing_;  // to the middle of the farthest cell
  const double distance = tree.signed_distance(centre);
  if (distance > reach) return;  // free, as all cells are at first
  if (size == 1 || distance <= -reach) {
    for (int z = first[2]; z < std::min(first[2] + size, count_[2]); ++z)
      for (int y = first[1]; y < std::min(first[1] + size, count_[1]); ++y)
        for (int x = first[0]; x < std::min(first[0] + size, count_[0]); ++x) cells_[index({x, y, z})] = Cell::Solid;
    return;
  }
  const int half = size / 2;
  for (int k = 0; k < 8; ++k)
    classify(tree, {first[0] + (k & 1) * half, first[1] + (k >> 1 & 1) * half, first[2] + (k >> 2) * half}, half);
}

void Cavities::flood() {
  std::vector<std::array<int, 3>> front{{0, 0, 0}};
  cells_[0] = Cell::Outer;
  while (!front.empty()) {
    const std::array<int, 3> cell = front.back();
    front.pop_back();
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int step : {-1, 1}) {
        std::array<int, 3> next = cell;
        next[axis] += step;
        if (next[axis] < 0 || next[axis] >= count_[axis]) continue;
        Cell& state = cells_[index(next)];
        if (state != Cell::Free) continue;
        state = Cell::Outer;
        front.push_back(next);
      }
  }
}

bool Cavities::beside(const Vector3d& point) const noexcept {
  if (!any_) return false;
  const Vector3d place = (point - origin_) / spacing_;
  std::array<int, 3> home{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double along = place[static_cast<Eigen::Index>(axis)];
    if (!(along >= 0 && along < count_[axis])) return false;
    home[axis] = static_cast<int>(along);
  }
  double least = 1e300;
  Cell nearest = Cell::Outer;
  for (int z = std::max(0, home[2] - 1); z <= std::min(count_[2] - 1, home[2] + 1); ++z)
    for (int y = std::max(0, home[1] - 1); y <= std::min(count_[1] - 1, home[1] + 1); ++y)
      for (int x = std::max(0, home[0] - 1); x <= std::min(count_[0] - 1, home[0] + 1); ++x) {
        const Cell state = cells_[index({x, y, z})];
        if (state == Cell::Solid) continue;
        const double distance = (place - Vector3d(x + 0.5, y + 0.5, z + 0.5)).squaredNorm();
        if (distance >= least) continue;
        least = distance;
        nearest = state;
      }
  return nearest == Cell::Free;
}

}  // namespace armature::sdk
