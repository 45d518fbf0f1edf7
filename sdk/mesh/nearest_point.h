#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace armature::sdk {

/// Finds the closest of some points, by a tree that halves them along their longest side. Built in n log n; thread-safe
/// to ask.
class NearestPoint {
 public:
  explicit NearestPoint(std::vector<Eigen::Vector3d> points);

  struct Found {
    std::uint32_t point = 0xFFFF'FFFF;  ///< in the order in which they came; of equally close ones any, always the same
    double distance2 = std::numeric_limits<double>::infinity();
  };
  /// The closest within a distance, of which the square is given, leaving out one point.
  [[nodiscard]] Found find(const Eigen::Vector3d& place, double within2 = std::numeric_limits<double>::infinity(),
                           std::uint32_t but = 0xFFFF'FFFF) const;
  /// The closest few, as many as `out` holds and there are, the closest first, leaving out one point; how many. Of
  /// equally close ones those that came first.
  std::size_t find(const Eigen::Vector3d& place, std::span<Found> out, std::uint32_t but = 0xFFFF'FFFF) const;

 private:
  static constexpr std::size_t kLeaf = 8;
  void split(std::size_t begin, std::size_t end);
  /// Shows `look` the points that may be as close to a place as it says, `look.within2()`.
  template <class Look>
  void search(std::size_t begin, std::size_t end, const Eigen::Vector3d& place, Look& look) const;

  std::vector<Eigen::Vector3d> points_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint8_t> axis_;  // by the place in `order_` of the point that splits
};

}  // namespace armature::sdk
