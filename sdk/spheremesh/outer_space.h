#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "sdk/spheremesh/union_gauge.h"

namespace armature::sdk {

/// What of the space around a union can be reached from far away, on a grid: tells its outer boundary from the walls of
/// its cavities. Gaps narrower than about a cell are taken for closed.
class OuterSpace {
 public:
  static constexpr int kCells = 80;

  /// A grid with this many cells along the longest side of the union.
  explicit OuterSpace(const UnionGauge& gauge, int cells = kCells);

  /// Looks anew, unless this union was the last one seen.
  void follow(const UnionGauge& gauge);

  [[nodiscard]] double cell_size() const noexcept { return size_; }
  /// Whether a boundary point with this outward normal looks into the outer space.
  [[nodiscard]] bool sees(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const noexcept;

 private:
  enum class Cell : std::uint8_t { Free, Taken, Outer };

  [[nodiscard]] std::size_t index(const std::array<int, 3>& at) const noexcept {
    const auto wide = [](int i) { return static_cast<std::size_t>(i); };
    return (wide(at[2]) * wide(extent_[1]) + wide(at[1])) * wide(extent_[0]) + wide(at[0]);
  }
  void look(const UnionGauge& gauge);
  void take(const UnionGauge& gauge, const NearbyPieces& pieces, const std::array<int, 3>& at, int width);
  void flood();
  [[nodiscard]] bool outer(const Eigen::Vector3d& point) const noexcept;

  int wanted_cells_;
  UnionGauge seen_;
  Eigen::Vector3d lower_ = Eigen::Vector3d::Zero();
  double size_ = 1;
  std::array<int, 3> extent_{};
  std::vector<Cell> cells_;
};

}  // namespace armature::sdk
