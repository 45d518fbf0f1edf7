#include "sdk/descriptors/nearest_point.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>

namespace armature::sdk {

NearestPoint::NearestPoint(std::vector<Eigen::Vector3d> points)
    : points_(std::move(points)), order_(points_.size()), axis_(points_.size()) {
  std::iota(order_.begin(), order_.end(), 0U);
  split(0, order_.size());
}

void NearestPoint::split(std::size_t begin, std::size_t end) {
  if (end - begin <= kLeaf) return;
  Eigen::AlignedBox3d box;
  for (std::size_t i = begin; i < end; ++i) box.extend(points_[order_[i]]);
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::size_t middle = begin + (end - begin) / 2;
  const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(points_[a][axis], a) < std::pair(points_[b][axis], b);
  });
  axis_[middle] = static_cast<std::uint8_t>(axis);
  split(begin, middle);
  split(middle + 1, end);
}

NearestPoint::Found NearestPoint::find(const Eigen::Vector3d& place, double within2, std::uint32_t but) const {
  Found found{.distance2 = within2};
  search(0, order_.size(), place, but, found);
  return found;
}

void NearestPoint::search(std::size_t begin, std::size_t end, const Eigen::Vector3d& place, std::uint32_t but,
                          Found& found) const {
  const auto look = [&](std::uint32_t i) {
    const double d2 = (points_[i] - place).squaredNorm();
    if (d2 < found.distance2 && i != but) found = {i, d2};
  };
  if (end - begin <= kLeaf) {
    for (std::size_t i = begin; i < end; ++i) look(order_[i]);
    return;
  }
  const std::size_t middle = begin + (end - begin) / 2;
  const auto axis = static_cast<Eigen::Index>(axis_[middle]);
  const double off = place[axis] - points_[order_[middle]][axis];
  look(order_[middle]);
  const auto below = [&] { search(begin, middle, place, but, found); };
  const auto above = [&] { search(middle + 1, end, place, but, found); };
  if (off < 0) {
    below();
    if (off * off < found.distance2) above();
  } else {
    above();
    if (off * off < found.distance2) below();
  }
}

}  // namespace armature::sdk
