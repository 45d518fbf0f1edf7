#include "sdk/expansion/enclosing_ball.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <Eigen/Dense>

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

constexpr double kRounding = 1e-10;  // of the radius

/// The smallest ball with all of up to four points on its sphere: its centre lies in their affine hull.
EnclosingBall circumscribed(std::span<const Vector3d> points) {
  const auto edges = static_cast<Eigen::Index>(points.size()) - 1;
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> Q(3, edges);
  for (Eigen::Index k = 0; k < edges; ++k) Q.col(k) = points[static_cast<std::size_t>(k) + 1] - points[0];
  // 2 Q'Q l = diag(Q'Q), centre = p0 + Q l.
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3> G = Q.transpose() * Q;
  const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1> half = 0.5 * G.diagonal();
  const Vector3d offset = edges > 0 ? Vector3d(Q * G.fullPivLu().solve(half)) : Vector3d(Vector3d::Zero());
  return {points[0] + offset, offset.norm()};
}

bool holds(const EnclosingBall& ball, std::span<const Vector3d> points) {
  return std::ranges::all_of(
      points, [&](const Vector3d& p) { return (p - ball.centre).norm() <= ball.radius * (1 + kRounding); });
}

/// The smallest ball around at most five points, and those on its sphere: the smallest circumscribed ball of some of
/// them that holds all.
EnclosingBall around_few(std::vector<Vector3d>& points) {
  EnclosingBall best{Vector3d::Zero(), std::numeric_limits<double>::infinity()};
  std::vector<Vector3d> support;
  for (unsigned chosen = 1; chosen < 1U << points.size(); ++chosen) {
    std::vector<Vector3d> some;
    for (std::size_t k = 0; k < points.size(); ++k)
      if ((chosen >> k & 1U) != 0) some.push_back(points[k]);
    if (some.size() > 4) continue;
    const EnclosingBall ball = circumscribed(some);
    if (ball.radius < best.radius && holds(ball, points)) {
      best = ball;
      support = std::move(some);
    }
  }
  if (!support.empty()) points = std::move(support);
  return best;
}

}  // namespace

EnclosingBall smallest_enclosing_ball(std::span<const Vector3d> points) {
  if (points.empty()) return {};
  // The farthest point joins those that hold the ball up, until none is outside: the radius grows each time.
  std::vector<Vector3d> support = {points[0]};
  EnclosingBall ball{points[0], 0};
  for (;;) {
    std::size_t farthest = 0;
    double most = -1;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (const double distance2 = (points[i] - ball.centre).squaredNorm(); distance2 > most) {
        most = distance2;
        farthest = i;
      }
    if (std::sqrt(most) <= ball.radius * (1 + kRounding)) return ball;
    support.push_back(points[farthest]);
    const EnclosingBall next = around_few(support);
    if (!(next.radius > ball.radius) || !std::isfinite(next.radius)) return ball;  // rounding decides no more
    ball = next;
  }
}

}  // namespace armature::sdk
