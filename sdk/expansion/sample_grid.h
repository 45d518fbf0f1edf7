#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "sdk/expansion/surface_samples.h"

namespace armature::sdk {

/// A piece of a surface as a grid of cells, each of which knows the mean sample of the cell of the surface that is
/// nearest to it, nearly: what is near a point is found in constant time, for laying surfaces onto one another roughly.
class SampleGrid {
 public:
  /// Of nothing.
  SampleGrid() = default;
  /// A cube of `kCells`^3 cells about a centre; samples outside of it are left out.
  SampleGrid(std::span<const SurfaceSample> samples, const Eigen::Vector3d& centre, double half_side);

  /// A mean sample near a point; nothing where the surface is more than `kFar` cells away.
  [[nodiscard]] const SurfaceSample* near(const Eigen::Vector3d& point) const noexcept {
    const auto cell = cell_of(point);
    return cell && !nearest_.empty() && nearest_[*cell] != kNone ? &means_[nearest_[*cell]] : nullptr;
  }

 private:
  static constexpr std::size_t kCells = 24;
  static constexpr int kFar = 4;
  static constexpr std::uint16_t kNone = 0xFFFF;

  [[nodiscard]] std::optional<std::size_t> cell_of(const Eigen::Vector3d& point) const noexcept {
    const Eigen::Vector3d x = (point - lowest_) * cells_per_length_;
    if (!(x.minCoeff() >= 0) || !(x.maxCoeff() < static_cast<double>(kCells))) return std::nullopt;
    return (static_cast<std::size_t>(x[0]) * kCells + static_cast<std::size_t>(x[1])) * kCells +
           static_cast<std::size_t>(x[2]);
  }

  Eigen::Vector3d lowest_ = Eigen::Vector3d::Zero();
  double cells_per_length_ = 0;
  std::vector<SurfaceSample> means_;
  std::vector<std::uint16_t> nearest_;  // of means_, by cell
};

}  // namespace armature::sdk
