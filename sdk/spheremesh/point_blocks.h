#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "sdk/spheremesh/union_gauge.h"

namespace armature::sdk {

/// A ball around points.
struct PointBall {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0;

  [[nodiscard]] static PointBall around(std::span<const Eigen::Vector3d> points) noexcept {
    Eigen::Vector3d lower = points[0];
    Eigen::Vector3d upper = points[0];
    for (const Eigen::Vector3d& p : points) lower = lower.cwiseMin(p), upper = upper.cwiseMax(p);
    PointBall ball{0.5 * (lower + upper), 0};
    for (const Eigen::Vector3d& p : points) ball.radius = std::max(ball.radius, (p - ball.centre).squaredNorm());
    ball.radius = std::sqrt(ball.radius);
    return ball;
  }
};

/// Calls `work(pieces, begin, end)` for blocks of consecutive points, on all cores, with the pieces that may be the
/// nearest to one of them or come nearer than `within`. Groups of blocks share a first choice of pieces.
template <class Work>
void for_each_block(const UnionGauge& gauge, std::span<const Eigen::Vector3d> points, double within, Work&& work) {
  constexpr std::size_t kBlock = 32;
  constexpr std::size_t kGroup = 16 * kBlock;
  const NearbyPieces all = gauge.all();
  const std::size_t groups = (points.size() + kGroup - 1) / kGroup;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, groups, 1), [&](const tbb::blocked_range<std::size_t>& range) {
    NearbyPieces of_group;
    NearbyPieces of_block;
    for (std::size_t g = range.begin(); g < range.end(); ++g) {
      const std::size_t last = std::min(points.size(), (g + 1) * kGroup);
      const PointBall group = PointBall::around(points.subspan(g * kGroup, last - g * kGroup));
      gauge.near(all, group.centre, group.radius, within, of_group);
      for (std::size_t begin = g * kGroup; begin < last; begin += kBlock) {
        const std::size_t end = std::min(last, begin + kBlock);
        const PointBall block = PointBall::around(points.subspan(begin, end - begin));
        gauge.near(of_group, block.centre, block.radius, within, of_block);
        work(of_block, begin, end);
      }
    }
  });
}

/// Where a point of the unit frame (every coordinate within about 0.6 of the origin) stands on a curve that fills it:
/// points near one another on the curve are near in space (Morton's order, ten bits an axis).
[[nodiscard]] inline std::uint32_t place_on_curve(const Eigen::Vector3d& point) noexcept {
  const auto spread = [](std::uint32_t x) {
    x = (x | x << 16) & 0x030000FFU;
    x = (x | x << 8) & 0x0300F00FU;
    x = (x | x << 4) & 0x030C30C3U;
    return (x | x << 2) & 0x09249249U;
  };
  const auto cell = [&](Eigen::Index axis) {
    return spread(static_cast<std::uint32_t>(std::clamp((point[axis] + 0.6) / 1.2 * 1024, 0.0, 1023.0)));
  };
  return cell(0) | cell(1) << 1 | cell(2) << 2;
}

}  // namespace armature::sdk
