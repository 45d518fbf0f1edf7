#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "sdk/spheremesh/gauge_lanes.h"
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
  // Each choice is made among the pieces of the one before.
  constexpr std::array<std::size_t, 3> kSizes{512, 64, kLanes};
  const NearbyPieces all = gauge.all();
  const auto choose = [&](const NearbyPieces& among, std::size_t begin, std::size_t end, NearbyPieces& chosen) {
    const PointBall ball = PointBall::around(points.subspan(begin, end - begin));
    gauge.near(among, ball.centre, ball.radius, within, chosen);
  };
  const std::size_t groups = (points.size() + kSizes[0] - 1) / kSizes[0];
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, groups, 1), [&](const tbb::blocked_range<std::size_t>& range) {
    std::array<NearbyPieces, 3> pieces;
    for (std::size_t i = range.begin() * kSizes[0]; i < std::min(points.size(), range.end() * kSizes[0]);
         i += kSizes[2]) {
      if (i % kSizes[0] == 0) choose(all, i, std::min(points.size(), i + kSizes[0]), pieces[0]);
      if (i % kSizes[1] == 0) choose(pieces[0], i, std::min(points.size(), i + kSizes[1]), pieces[1]);
      const std::size_t end = std::min(points.size(), i + kSizes[2]);
      choose(pieces[1], i, end, pieces[2]);
      work(pieces[2], i, end);
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
