#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace armature::sdk {

/// The part of a sphere's directions, signed, that a triangle (a, b, c) covers as seen from a point (van Oosterom and
/// Strackee 1983). Summed over a closed surface: how often it winds around the point.
[[nodiscard]] double winding(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                             const Eigen::Vector3d& point) noexcept;

/// A part of a surface that may lie within another.
struct NestedPart {
  Eigen::AlignedBox3d box;
  Eigen::Vector3d point;  ///< of its surface
  bool inward = false;    ///< judged by itself
};

/// Says of each part of a surface whether it is inside out: whether the outermost part around it, itself if there is
/// none, points inward. So cavities stay cavities.
class Nesting {
 public:
  /// How often the surface of a part winds around a point.
  using Winding = std::function<double(std::size_t part, const Eigen::Vector3d& point)>;

  Nesting(std::vector<NestedPart> parts, Winding winding);

  [[nodiscard]] bool points_inward(std::size_t part) const;
  /// Whether some part does.
  [[nodiscard]] bool any_inward() const noexcept { return !inward_.empty(); }

 private:
  /// Whether a box is the larger one and contains the other.
  [[nodiscard]] bool may_hold(std::size_t outer, std::size_t inner) const;

  std::vector<NestedPart> parts_;
  Winding winding_;
  std::vector<double> sizes_;         // of the boxes
  std::vector<std::size_t> by_size_;  // falling
  std::vector<std::size_t> inward_;   // the same of those that point inward by themselves
};

}  // namespace armature::sdk
