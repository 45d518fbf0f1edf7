#include "sdk/mesh/nesting.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <numeric>
#include <utility>

namespace armature::sdk {

using Eigen::Vector3d;

double winding(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& point) noexcept {
  const Vector3d to_a = a - point;
  const Vector3d to_b = b - point;
  const Vector3d to_c = c - point;
  const double la = to_a.norm();
  const double lb = to_b.norm();
  const double lc = to_c.norm();
  const double half = std::atan2(to_a.dot(to_b.cross(to_c)),
                                 la * lb * lc + to_a.dot(to_b) * lc + to_b.dot(to_c) * la + to_c.dot(to_a) * lb);
  return half / (2 * std::numbers::pi);
}

Nesting::Nesting(std::vector<NestedPart> parts, Winding winding)
    : parts_(std::move(parts)), winding_(std::move(winding)), by_size_(parts_.size()) {
  sizes_.reserve(parts_.size());
  for (const auto& part : parts_) sizes_.push_back(part.box.diagonal().squaredNorm());
  std::iota(by_size_.begin(), by_size_.end(), std::size_t{0});
  std::stable_sort(by_size_.begin(), by_size_.end(),
                   [&](std::size_t a, std::size_t b) { return sizes_[a] > sizes_[b]; });
  std::copy_if(by_size_.begin(), by_size_.end(), std::back_inserter(inward_),
               [&](std::size_t part) { return parts_[part].inward; });
}

bool Nesting::may_hold(std::size_t outer, std::size_t inner) const {
  return sizes_[outer] > sizes_[inner] && parts_[outer].box.contains(parts_[inner].box);
}

bool Nesting::points_inward(std::size_t part) const {
  // What can lie in nothing that points inward is as it is.
  if (!parts_[part].inward &&
      std::none_of(inward_.begin(), inward_.end(), [&](std::size_t outer) { return may_hold(outer, part); }))
    return false;
  for (const std::size_t outer : by_size_) {
    if (sizes_[outer] <= sizes_[part]) break;
    constexpr double kInside = 0.5;
    if (may_hold(outer, part) && std::abs(winding_(outer, parts_[part].point)) > kInside) return parts_[outer].inward;
  }
  return parts_[part].inward;
}

}  // namespace armature::sdk
