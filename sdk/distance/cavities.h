#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <armature/sdk/distance/sphere_mesh_tree.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// Which of the space that a sphere-mesh leaves free is shut off from infinity. Decided on a grid: its cells with
/// 0.4 cells free around their middle are flooded from outside, face to face, wherever the way between the middles is
/// free. A void whose way out is narrower than a cell counts as closed.
class Cavities {
 public:
  /// `resolution` cells along the longest side of the bounding box. What was stopped meanwhile tells nothing.
  Cavities(const SphereMeshTree& tree, int resolution, const Task& task = {});

  /// Whether there is any closed void with a free cell.
  [[nodiscard]] bool any() const noexcept { return any_; }
  enum class Space : std::uint8_t { Narrow, Open, Closed };
  /// What free space at a point belongs to. From there it is walked away from the surface, and then searched ball by
  /// ball, until a free ball holds the middle of a cell, which is open or closed; where none does, the space is
  /// narrower than a cell.
  [[nodiscard]] Space space_at(const SphereMeshTree& tree, const Eigen::Vector3d& point) const;
  /// Whether it belongs to a closed void; what is narrower than a cell counts as closed.
  [[nodiscard]] bool holds(const SphereMeshTree& tree, const Eigen::Vector3d& point) const {
    return space_at(tree, point) != Space::Open;
  }
  /// The same for the free space in front of a point of the surface.
  [[nodiscard]] bool faces(const SphereMeshTree& tree, const Eigen::Vector3d& point,
                           const Eigen::Vector3d& normal) const;

 private:
  enum class Cell : std::uint8_t { Solid, Free, Outer };

  /// What the free ball around a place tells, and what bounds it.
  [[nodiscard]] Space look(const SphereMeshTree& tree, const Eigen::Vector3d& x, NearestSphere& nearest) const noexcept;
  [[nodiscard]] Space explore(const SphereMeshTree& tree, const Eigen::Vector3d& point) const;

  void classify(const SphereMeshTree& tree, const std::array<int, 3>& first, int size, const Task& task);
  void flood(const SphereMeshTree& tree, const Task& task);
  /// Whether the way between the middles of two neighbouring free cells is free all along.
  [[nodiscard]] bool joined(const SphereMeshTree& tree, const std::array<int, 3>& a, const std::array<int, 3>& b) const;
  [[nodiscard]] Eigen::Vector3d middle(const std::array<int, 3>& cell) const noexcept;
  [[nodiscard]] std::size_t index(const std::array<int, 3>& cell) const noexcept {
    return (static_cast<std::size_t>(cell[2]) * static_cast<std::size_t>(count_[1]) +
            static_cast<std::size_t>(cell[1])) *
               static_cast<std::size_t>(count_[0]) +
           static_cast<std::size_t>(cell[0]);
  }

  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  double spacing_ = 1;
  std::array<int, 3> count_{};
  std::vector<Cell> cells_;
  std::vector<float> free_around_;  // at the middle of each cell, while flooding
  bool any_ = false;
};

}  // namespace armature::sdk
