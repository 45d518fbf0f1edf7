#include "sdk/hierarchy/qem_metric.h"

#include <algorithm>

#include <Eigen/Geometry>

namespace armature::sdk {
namespace {

/// A side of a triangle: its ends, the smaller one first, and the corner opposite.
struct Side {
  std::uint32_t a, b, opposite;
  friend auto operator<=>(const Side&, const Side&) = default;
};

std::vector<Side> sides_of(const NormalisedShape& shape) {
  std::vector<Side> sides;
  sides.reserve(3 * shape.triangles.size());
  for (const auto& t : shape.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      sides.push_back({std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3]), t[(k + 2) % 3]});
  std::sort(sides.begin(), sides.end());
  return sides;
}

}  // namespace

QemMetric::QemMetric(const NormalisedShape& shape, double boundary_weight)
    : quadrics_(shape.positions.size()), points_(shape.positions) {
  for (const auto& t : shape.triangles) {
    const Eigen::Vector3d cross = (points_[t[1]] - points_[t[0]]).cross(points_[t[2]] - points_[t[0]]);
    const double length = cross.norm();
    if (!(length > 0)) continue;
    // The plane passes through each of its corners, about which their quadrics are.
    for (const auto v : t) quadrics_[v].add_plane(cross / length, 0, length / 6);
  }
  if (!(boundary_weight > 0)) return;
  const auto sides = sides_of(shape);
  for (std::size_t k = 0; k < sides.size();) {
    std::size_t end = k + 1;
    while (end < sides.size() && sides[end].a == sides[k].a && sides[end].b == sides[k].b) ++end;
    if (end - k != 2) {
      for (; k < end; ++k) {
        const Eigen::Vector3d side = points_[sides[k].b] - points_[sides[k].a];
        const Eigen::Vector3d inward = points_[sides[k].opposite] - points_[sides[k].a];
        const Eigen::Vector3d upright = inward - inward.dot(side) / std::max(side.squaredNorm(), 1e-300) * side;
        const double height = upright.norm();
        if (!(height > 0)) continue;
        for (const auto v : {sides[k].a, sides[k].b})
          quadrics_[v].add_plane(upright / height, 0, boundary_weight * side.squaredNorm());
      }
    }
    k = end;
  }
}

QemMetric::Fit QemMetric::fit(std::uint32_t a, std::uint32_t b) const noexcept {
  const Eigen::Vector3d offset = points_[b] - points_[a];
  Quadric q = quadrics_[a];
  q.add(quadrics_[b], offset);
  return least_of(q, offset);
}

double QemMetric::cost(std::span<const std::uint32_t> slots) const noexcept {
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  Quadric q = quadrics_[slots.front()];
  for (const std::uint32_t b : slots.subspan(1)) {
    offset = points_[b] - points_[slots.front()];
    q.add(quadrics_[b], offset);
  }
  return least_of(q, offset).cost;
}

QemMetric::Fit QemMetric::least_of(const Quadric& q, const Eigen::Vector3d& offset) noexcept {
  const auto result = [&](const Eigen::Vector3d& x) { return Fit{x, std::max(q.at(x), 0.0)}; };

  const double cxx = q.yy * q.zz - q.yz * q.yz, cxy = q.xz * q.yz - q.xy * q.zz, cxz = q.xy * q.yz - q.xz * q.yy;
  const double cyy = q.xx * q.zz - q.xz * q.xz, cyz = q.xy * q.xz - q.xx * q.yz, czz = q.xx * q.yy - q.xy * q.xy;
  const double det = q.xx * cxx + q.xy * cxy + q.xz * cxz;
  const double minors = cxx + cyy + czz;
  // det / minors is about the smallest eigenvalue: relative to the largest, as in SphereDomain.
  constexpr double kPivot = 1e-4;
  if (minors > 0 && det > kPivot * (q.xx + q.yy + q.zz) * minors) {
    const Eigen::Vector3d x(cxx * q.bx + cxy * q.by + cxz * q.bz, cxy * q.bx + cyy * q.by + cyz * q.bz,
                            cxz * q.bx + cyz * q.by + czz * q.bz);
    return result(x / det);
  }
  const Eigen::Vector3d along = q.times(offset);
  const double stiffness = offset.dot(along);
  if (stiffness > kPivot * (q.xx + q.yy + q.zz) * offset.squaredNorm()) {
    const double lambda = (q.bx * offset.x() + q.by * offset.y() + q.bz * offset.z()) / stiffness;
    return result(std::clamp(lambda, 0.0, 1.0) * offset);
  }
  return result(0.5 * offset);
}

void QemMetric::merge(std::uint32_t kept, std::uint32_t gone, const Fit& from_kept) noexcept {
  Quadric sum = quadrics_[kept];
  sum.add(quadrics_[gone], points_[gone] - points_[kept]);
  quadrics_[kept] = {};
  quadrics_[kept].add(sum, -from_kept.offset);
  points_[kept] += from_kept.offset;
}

void QemMetric::Quadric::add_plane(const Eigen::Vector3d& n, double offset, double weight) noexcept {
  xx += weight * n.x() * n.x();
  xy += weight * n.x() * n.y();
  xz += weight * n.x() * n.z();
  yy += weight * n.y() * n.y();
  yz += weight * n.y() * n.z();
  zz += weight * n.z() * n.z();
  bx += weight * offset * n.x();
  by += weight * offset * n.y();
  bz += weight * offset * n.z();
  c += weight * offset * offset;
}

Eigen::Vector3d QemMetric::Quadric::times(const Eigen::Vector3d& x) const noexcept {
  return {xx * x.x() + xy * x.y() + xz * x.z(), xy * x.x() + yy * x.y() + yz * x.z(),
          xz * x.x() + yz * x.y() + zz * x.z()};
}

void QemMetric::Quadric::add(const Quadric& other, const Eigen::Vector3d& t) noexcept {
  xx += other.xx;
  xy += other.xy;
  xz += other.xz;
  yy += other.yy;
  yz += other.yz;
  zz += other.zz;
  const Eigen::Vector3d moved = other.times(t);
  bx += other.bx + moved.x();
  by += other.by + moved.y();
  bz += other.bz + moved.z();
  c += other.c + 2 * (other.bx * t.x() + other.by * t.y() + other.bz * t.z()) + moved.dot(t);
}

double QemMetric::Quadric::at(const Eigen::Vector3d& x) const noexcept {
  return x.dot(times(x)) - 2 * (bx * x.x() + by * x.y() + bz * x.z()) + c;
}

}  // namespace armature::sdk
