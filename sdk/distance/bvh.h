#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace armature::sdk {

/// The frame a tree is built in: the shape moved to the origin and scaled to at most 1 in every direction, so that
/// single precision carries the same meaning at every scale and place.
struct UnitFrame {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  double scale = 1;  ///< units of the frame in a unit of the shape

  UnitFrame() = default;
  UnitFrame(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper) noexcept;

  [[nodiscard]] Eigen::Vector3f to_unit(const Eigen::Vector3d& point) const noexcept {
    return ((point - origin) * scale).cast<float>();
  }
};

/// A box in the unit frame, of four lanes (the last one idle) so that it moves as one register.
struct UnitBox {
  Eigen::Array4f lower = Eigen::Array4f::Constant(std::numeric_limits<float>::infinity());
  Eigen::Array4f upper = Eigen::Array4f::Constant(-std::numeric_limits<float>::infinity());

  void add(const UnitBox& other) noexcept {
    lower = lower.min(other.lower);
    upper = upper.max(other.upper);
  }
  [[nodiscard]] float half_area() const noexcept {
    const Eigen::Array4f e = upper - lower;
    return e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
  }
};

/// The box of what lies between two corners, padded by what single precision may round off.
[[nodiscard]] UnitBox unit_box(const UnitFrame& frame, const Eigen::Vector3d& lower,
                               const Eigen::Vector3d& upper) noexcept;

/// A hierarchy of boxes, four to a node, built by binned surface-area splits; the same for the same boxes always.
class Bvh {
 public:
  static constexpr float kSlack = 2e-6F;  ///< what a bound in single precision may be too large by, unit frame
  static constexpr std::size_t kStack = 320;

  struct alignas(16) Node {
    std::array<Eigen::Array4f, 3> lower, upper;  ///< by axis, then by child; unused children are inside out
    std::array<std::int32_t, 4> child;           ///< a node; or ~(first * 8 + count - 1), a run of items
  };

  /// Leaves hold at most `leaf_size` (up to 8) boxes.
  Bvh() = default;
  Bvh(std::span<const UnitBox> boxes, std::size_t leaf_size);

  /// The boxes in the order that leaves name them.
  [[nodiscard]] const std::vector<std::uint32_t>& order() const noexcept { return order_; }
  [[nodiscard]] bool empty() const noexcept { return nodes_.empty(); }

  /// Visits leaves nearest first: `bound(node)` gives a lower bound for each child, `visit(first, count)` looks at a
  /// run of items and returns the new limit. What lies beyond the limit is left out. Throws what they throw.
  template <class Bound, class Visit>
  void descend(float limit, Bound&& bound, Visit&& visit) const;

 private:
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
};

template <class Bound, class Visit>
void Bvh::descend(float limit, Bound&& bound, Visit&& visit) const {
  if (nodes_.empty()) return;
  struct Entry {
    float bound;
    std::int32_t child;
  };
  std::array<Entry, kStack> stack;
  std::size_t size = 0;
  std::int32_t at = 0;
  for (;;) {
    if (at >= 0) {
      const Node& node = nodes_[static_cast<std::size_t>(at)];
      const Eigen::Array4f near = bound(node);
      const std::size_t base = size;
      for (std::size_t k = 0; k < 4; ++k) {
        const float b = near[static_cast<Eigen::Index>(k)];
        if (!(b <= limit)) continue;
        std::size_t place = size++;
        for (; place > base && stack[place - 1].bound < b; --place) stack[place] = stack[place - 1];
        stack[place] = {b, node.child[k]};
      }
    } else {
      const auto run = static_cast<std::uint32_t>(~at);
      limit = visit(static_cast<std::size_t>(run >> 3), static_cast<std::size_t>(run & 7) + 1);
    }
    do {
      if (size == 0) return;
      --size;
    } while (stack[size].bound > limit);
    at = stack[size].child;
  }
}

/// Squared distance to each child's box; infinite for an unused one.
[[nodiscard]] inline Eigen::Array4f squared_distances(const Bvh::Node& node, const Eigen::Vector3f& p) noexcept {
  Eigen::Array4f sum = Eigen::Array4f::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const float x = p[static_cast<Eigen::Index>(k)];
    const Eigen::Array4f d = (node.lower[k] - x).max(x - node.upper[k]).max(0.0F);
    sum += d * d;
  }
  return sum;
}

/// 0 for each child whose box meets another one, infinite for the rest.
[[nodiscard]] inline Eigen::Array4f misses(const Bvh::Node& node, const UnitBox& box) noexcept {
  Eigen::Array4f result = Eigen::Array4f::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    result = (node.lower[k] <= box.upper[axis] && node.upper[k] >= box.lower[axis])
                 .select(result, std::numeric_limits<float>::infinity());
  }
  return result;
}

/// Distance to each child's box, negative inside: below the signed distance to anything the box holds.
[[nodiscard]] inline Eigen::Array4f signed_distances(const Bvh::Node& node, const Eigen::Vector3f& p) noexcept {
  Eigen::Array4f sum = Eigen::Array4f::Zero();
  Eigen::Array4f most = Eigen::Array4f::Constant(-std::numeric_limits<float>::infinity());
  for (std::size_t k = 0; k < 3; ++k) {
    const float x = p[static_cast<Eigen::Index>(k)];
    const Eigen::Array4f d = (node.lower[k] - x).max(x - node.upper[k]);
    const Eigen::Array4f out = d.max(0.0F);
    most = most.max(d);
    sum += out * out;
  }
  return sum.sqrt() + most.min(0.0F);
}

/// A ray prepared for boxes in the unit frame; its parameter is that of the ray.
struct UnitRay {
  std::array<float, 3> origin, inverse;
  UnitRay(const UnitFrame& frame, const Eigen::Vector3d& from, const Eigen::Vector3d& direction) noexcept;
};

/// Where the ray enters each child's box, not below 0; infinite where it misses.
[[nodiscard]] inline Eigen::Array4f entries(const Bvh::Node& node, const UnitRay& ray) noexcept {
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  constexpr float kWider = 1 + 4e-6F;
  Eigen::Array4f first = Eigen::Array4f::Zero();
  Eigen::Array4f last = Eigen::Array4f::Constant(kInfinite);
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Array4f a = (node.lower[k] - ray.origin[k]) * ray.inverse[k];
    const Eigen::Array4f b = (node.upper[k] - ray.origin[k]) * ray.inverse[k];
    first = first.max(a.min(b));
    last = last.min(a.max(b));
  }
  return (first <= last * kWider).select(first / kWider, kInfinite);
}

}  // namespace armature::sdk
