#include "sdk/mesh/nearest_point.h"

#include <algorithm>
#include <cmath>
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

template <class Look>
void NearestPoint::search(std::size_t begin, std::size_t end, const Eigen::Vector3d& place, Look& look) const {
  const auto show = [&](std::uint32_t i) { look(i, (points_[i] - place).squaredNorm()); };
  if (end - begin <= kLeaf) {
    for (std::size_t i = begin; i < end; ++i) show(order_[i]);
    return;
  }
  const std::size_t middle = begin + (end - begin) / 2;
  const auto axis = static_cast<Eigen::Index>(axis_[middle]);
  const double off = place[axis] - points_[order_[middle]][axis];
  show(order_[middle]);
  const auto below = [&] { search(begin, middle, place, look); };
  const auto above = [&] { search(middle + 1, end, place, look); };
  if (off < 0) {
    below();
    if (off * off < look.within2()) above();
  } else {
    above();
    if (off * off < look.within2()) below();
  }
}

NearestPoint::Found NearestPoint::find(const Eigen::Vector3d& place, double within2, std::uint32_t but) const {
  struct Closest {
    Found found;
    std::uint32_t but;

    void operator()(std::uint32_t i, double d2) {
      if (d2 < found.distance2 && i != but) found = {i, d2};
    }
    [[nodiscard]] double within2() const { return found.distance2; }
  } closest{{.distance2 = within2}, but};
  search(0, order_.size(), place, closest);
  return closest.found;
}

std::size_t NearestPoint::find(const Eigen::Vector3d& place, std::span<Found> out, std::uint32_t but) const {
  struct ClosestFew {
    std::span<Found> found;  // the first `count` ascending
    std::uint32_t but;
    std::size_t count = 0;

    void operator()(std::uint32_t i, double d2) {
      const auto before = [&](const Found& other) {
        return std::pair(d2, i) < std::pair(other.distance2, other.point);
      };
      if (i == but || (count == found.size() && !before(found.back()))) return;
      std::size_t at = count == found.size() ? count - 1 : count++;
      for (; at > 0 && before(found[at - 1]); --at) found[at] = found[at - 1];
      found[at] = {i, d2};
    }
    // Equally close ones are to be seen, too.
    [[nodiscard]] double within2() const {
      return count < found.size() ? std::numeric_limits<double>::infinity()
                                  : std::nextafter(found.back().distance2, std::numeric_limits<double>::infinity());
    }
  } few{out, but};
  if (!out.empty()) search(0, order_.size(), place, few);
  return few.count;
}

}  // namespace armature::sdk
