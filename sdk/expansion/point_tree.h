#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace armature::sdk {

/// A point of a surface with the area that it stands for.
struct OrientedPoint {
  Eigen::Vector3f position;
  Eigen::Vector3f normal;  ///< of unit length, or zero
  float area;
};

/// Takes points together that lie within a box of diagonal `spacing` and face alike: their mean by area. The order is
/// that of a tree over space. Uses all cores; the same on any number of them.
[[nodiscard]] std::vector<OrientedPoint> merged(std::vector<OrientedPoint> points, float spacing);

/// Points side by side, coordinate by coordinate, so that several are looked at at once.
struct PointColumns {
  std::vector<float> x, y, z, nx, ny, nz, area;

  [[nodiscard]] std::size_t size() const noexcept { return x.size(); }
  [[nodiscard]] OrientedPoint at(std::size_t i) const noexcept {
    return {{x[i], y[i], z[i]}, {nx[i], ny[i], nz[i]}, area[i]};
  }
  void set(std::size_t i, const OrientedPoint& point) noexcept;
  void resize(std::size_t count);
  void clear() { resize(0); }
  /// Appends a run of others.
  void append(const PointColumns& others, std::size_t begin, std::size_t end);
  /// Fills up to a multiple of `block` with points at infinity, which lie in no ball.
  void pad(std::size_t block);
};

/// Points in groups of neighbours, over a tree of boxes.
class PointTree {
 public:
  static constexpr std::size_t kGroup = 32;

  explicit PointTree(std::span<const OrientedPoint> points);

  /// All points, group after group.
  [[nodiscard]] const PointColumns& points() const noexcept { return points_; }
  /// What the constructor calls the points, in the same order.
  [[nodiscard]] const std::vector<std::uint32_t>& order() const noexcept { return order_; }
  /// Replaces a normal.
  void set_normal(std::size_t place, const Eigen::Vector3f& normal) noexcept;

  [[nodiscard]] std::size_t groups() const noexcept { return (order_.size() + kGroup - 1) / kGroup; }
  /// The points of a group lie from `group * kGroup` to this place.
  [[nodiscard]] std::size_t end_of(std::size_t group) const noexcept {
    return std::min(order_.size(), (group + 1) * kGroup);
  }
  [[nodiscard]] const Eigen::AlignedBox3f& box_of(std::size_t group) const noexcept {
    return boxes_[first_leaf_ + group];
  }
  /// Appends, in order, at least all points that lie within `radius` of some point of a box.
  void gather(const Eigen::AlignedBox3f& around, float radius, PointColumns& out) const;

 private:
  std::vector<std::uint32_t> order_;
  PointColumns points_;
  std::vector<Eigen::AlignedBox3f> boxes_;  // a full binary tree: children of i are 2 i + 1, 2 i + 2; leaves are groups
  std::size_t first_leaf_ = 0;
};

}  // namespace armature::sdk
