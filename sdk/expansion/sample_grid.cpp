#include "sdk/expansion/sample_grid.h"

namespace armature::sdk {

SampleGrid::SampleGrid(std::span<const SurfaceSample> samples, const Eigen::Vector3d& centre, double half_side)
    : lowest_(centre - Eigen::Vector3d::Constant(half_side)),
      cells_per_length_(static_cast<double>(kCells) / (2 * half_side)),
      nearest_(kCells * kCells * kCells, kNone) {
  std::vector<std::size_t> reached;
  for (const SurfaceSample& sample : samples) {
    const auto cell = cell_of(sample.point);
    if (!cell) continue;
    if (nearest_[*cell] == kNone) {
      nearest_[*cell] = static_cast<std::uint16_t>(means_.size());
      means_.push_back({Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), 0, sample.face});
      reached.push_back(*cell);
    }
    SurfaceSample& mean = means_[nearest_[*cell]];
    // Of two sides of a sheet in one cell, the first.
    if (mean.normal.dot(sample.normal) < 0) continue;
    mean.point += sample.area * sample.point;
    mean.normal += sample.area * sample.normal;
    mean.area += sample.area;
  }
  for (SurfaceSample& mean : means_) {
    mean.point /= mean.area;
    mean.normal.normalize();
  }
  // From cell to cell, a ring at a time.
  std::vector<std::size_t> next;
  for (int ring = 0; ring < kFar; ++ring) {
    next.clear();
    for (const std::size_t cell : reached) {
      const std::array<std::size_t, 3> at = {cell / (kCells * kCells), cell / kCells % kCells, cell % kCells};
      std::size_t stride = kCells * kCells;
      for (std::size_t axis = 0; axis < 3; ++axis, stride /= kCells) {
        const auto reach = [&](std::size_t neighbour) {
          if (nearest_[neighbour] != kNone) return;
          nearest_[neighbour] = nearest_[cell];
          next.push_back(neighbour);
        };
        if (at[axis] > 0) reach(cell - stride);
        if (at[axis] + 1 < kCells) reach(cell + stride);
      }
    }
    reached.swap(next);
  }
}

}  // namespace armature::sdk
