#include "sdk/expansion/point_tree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <numeric>
#include <utility>

#include <tbb/parallel_invoke.h>

namespace armature::sdk {
namespace {

constexpr std::array kColumns = {&PointColumns::x,  &PointColumns::y,  &PointColumns::z,   &PointColumns::nx,
                                 &PointColumns::ny, &PointColumns::nz, &PointColumns::area};

constexpr std::size_t kWorthATask = 4096;
constexpr float kAlike = 0.8F;  // how long the mean of unit normals must be for their points to face alike

Eigen::AlignedBox3f box_of(std::span<const OrientedPoint> points) {
  Eigen::AlignedBox3f box;
  for (const OrientedPoint& point : points) box.extend(point.position);
  return box;
}

/// Along which axis a box is longest.
Eigen::Index longest_axis(const Eigen::AlignedBox3f& box) {
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  return axis;
}

template <class Left, class Right>
void both(std::size_t size, const Left& left, const Right& right) {
  if (size > kWorthATask) {
    tbb::parallel_invoke(left, right);
  } else {
    left();
    right();
  }
}

/// Sorts points so that the first half, a whole number of groups, lies on one side of the longest axis.
void split(std::span<std::uint32_t> order, std::span<const OrientedPoint> points, std::size_t leaves) {
  if (leaves <= 1 || order.size() <= PointTree::kGroup) return;
  const std::size_t half = std::min(order.size(), leaves / 2 * PointTree::kGroup);
  Eigen::AlignedBox3f box;
  for (const std::uint32_t i : order) box.extend(points[i].position);
  const Eigen::Index axis = longest_axis(box);
  if (half < order.size())
    std::ranges::nth_element(order, order.begin() + static_cast<std::ptrdiff_t>(half), {},
                             [&](std::uint32_t i) { return std::pair(points[i].position[axis], i); });
  both(
      order.size(), [&] { split(order.first(half), points, leaves / 2); },
      [&] { split(order.subspan(half), points, leaves / 2); });
}

/// Merges the points of a run, which it sorts, and moves what remains to its front; returns how many those are.
std::size_t merge(std::span<OrientedPoint> run, float spacing) {
  if (run.size() <= 1) return run.size();
  const Eigen::AlignedBox3f box = box_of(run);
  if (box.sizes().norm() <= spacing) {
    OrientedPoint mean{Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero(), 0};
    for (const OrientedPoint& point : run) {
      mean.position += point.area * point.position;
      mean.normal += point.area * point.normal;
      mean.area += point.area;
    }
    const float length = mean.normal.norm();
    if (mean.area > 0 && length >= kAlike * mean.area) {
      run[0] = {mean.position / mean.area, mean.normal / length, mean.area};
      return 1;
    }
    if (!(box.sizes().maxCoeff() > 0)) return run.size();  // all in one place, facing apart
  }
  const std::size_t half = run.size() / 2;
  const Eigen::Index axis = longest_axis(box);
  std::ranges::nth_element(
      run, run.begin() + static_cast<std::ptrdiff_t>(half), [axis](const OrientedPoint& a, const OrientedPoint& b) {
        if (a.position[axis] != b.position[axis]) return a.position[axis] < b.position[axis];
        return std::lexicographical_compare(a.position.begin(), a.position.end(), b.position.begin(), b.position.end());
      });
  std::size_t left = 0;
  std::size_t right = 0;
  both(
      run.size(), [&] { left = merge(run.first(half), spacing); }, [&] { right = merge(run.subspan(half), spacing); });
  std::move(run.begin() + static_cast<std::ptrdiff_t>(half), run.begin() + static_cast<std::ptrdiff_t>(half + right),
            run.begin() + static_cast<std::ptrdiff_t>(left));
  return left + right;
}

}  // namespace

void PointColumns::resize(std::size_t count) {
  for (const auto column : kColumns) (this->*column).resize(count);
}

void PointColumns::append(const PointColumns& others, std::size_t begin, std::size_t end) {
  for (const auto column : kColumns) {
    const auto from = (others.*column).begin();
    (this->*column)
        .insert((this->*column).end(), from + static_cast<std::ptrdiff_t>(begin),
                from + static_cast<std::ptrdiff_t>(end));
  }
}

void PointColumns::pad(std::size_t block) {
  const std::size_t count = size();
  resize((count + block - 1) / block * block);
  std::fill(x.begin() + static_cast<std::ptrdiff_t>(count), x.end(), std::numeric_limits<float>::infinity());
}

void PointColumns::set(std::size_t i, const OrientedPoint& point) noexcept {
  x[i] = point.position.x();
  y[i] = point.position.y();
  z[i] = point.position.z();
  nx[i] = point.normal.x();
  ny[i] = point.normal.y();
  nz[i] = point.normal.z();
  area[i] = point.area;
}

std::vector<OrientedPoint> merged(std::vector<OrientedPoint> points, float spacing) {
  points.erase(points.begin() + static_cast<std::ptrdiff_t>(merge(points, spacing)), points.end());
  return points;
}

PointTree::PointTree(std::span<const OrientedPoint> points) : order_(points.size()) {
  const std::size_t leaves = std::bit_ceil(std::max<std::size_t>(1, groups()));
  std::iota(order_.begin(), order_.end(), 0U);
  split(order_, points, leaves);
  points_.resize(points.size());
  first_leaf_ = leaves - 1;
  boxes_.resize(2 * leaves - 1);
  for (std::size_t at = 0; at < order_.size(); ++at) {
    points_.set(at, points[order_[at]]);
    boxes_[first_leaf_ + at / kGroup].extend(points[order_[at]].position);
  }
  for (std::size_t node = first_leaf_; node-- > 0;) boxes_[node] = boxes_[2 * node + 1].merged(boxes_[2 * node + 2]);
}

void PointTree::set_normal(std::size_t place, const Eigen::Vector3f& normal) noexcept {
  points_.nx[place] = normal.x();
  points_.ny[place] = normal.y();
  points_.nz[place] = normal.z();
}

void PointTree::gather(const Eigen::AlignedBox3f& around, float radius, PointColumns& out) const {
  if (around.isEmpty()) return;
  const float within = radius * radius * (1 + 1e-5F);
  const auto near = [&](std::size_t node) {
    return !boxes_[node].isEmpty() && boxes_[node].squaredExteriorDistance(around) <= within;
  };
  std::array<std::size_t, 64> stack{};
  std::size_t size = 0;
  if (near(0)) stack[size++] = 0;
  while (size > 0) {
    const std::size_t node = stack[--size];
    if (node < first_leaf_) {
      for (const std::size_t child : {2 * node + 2, 2 * node + 1})
        if (near(child)) stack[size++] = child;
      continue;
    }
    const std::size_t begin = (node - first_leaf_) * kGroup;
    out.append(points_, begin, end_of(node - first_leaf_));
  }
}

}  // namespace armature::sdk
