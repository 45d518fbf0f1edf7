#include "tracker/segmentation/flatness.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>

namespace armature {
namespace {

constexpr std::size_t kMaxPoints = 400;
constexpr int kTrials = 60;
constexpr float kTolerance = 0.8F * kDisparityStep;

struct Point {
  float ray_x, ray_y, inverse_depth;
};

}  // namespace

float flatness(const DepthGrid& grid, std::span<const std::uint8_t> labels, std::uint8_t label) noexcept {
  const auto cells = static_cast<std::size_t>(std::ranges::count(labels, label));
  const std::size_t step = 1 + cells / kMaxPoints;
  std::array<Point, kMaxPoints> points;
  std::size_t count = 0;
  for (std::size_t i = 0, seen = 0; i < labels.size(); ++i) {
    if (labels[i] != label || seen++ % step != 0 || count == kMaxPoints) continue;
    const std::size_t width = static_cast<std::size_t>(grid.width);
    points[count++] = {grid.ray_x[i % width], grid.ray_y[i / width], grid.inverse_depth[i]};
  }
  const std::size_t all = count;
  if (all < 12) return 0;
  std::uint32_t state = 0x2545F491U;
  const auto random = [&](std::size_t below) {
    state ^= state << 13;
    state ^= state >> 17;
    state ^= state << 5;
    return state % below;
  };
  std::size_t flat = 0;
  for (int plane = 0; plane < 2 && count >= 12; ++plane) {
    Eigen::Vector3f best = Eigen::Vector3f::Zero();
    std::size_t most = 0;
    const auto on = [&](const Eigen::Vector3f& abc, const Point& p) {
      return std::abs(abc.x() * p.ray_x + abc.y() * p.ray_y + abc.z() - p.inverse_depth) < kTolerance;
    };
    const auto points_on = [&](const Eigen::Vector3f& abc) {
      std::size_t n = 0;
      for (std::size_t k = 0; k < count; ++k) n += on(abc, points[k]);
      return n;
    };
    for (int trial = 0; trial < kTrials; ++trial) {
      Eigen::Matrix3f rays;
      Eigen::Vector3f w;
      for (int k = 0; k < 3; ++k) {
        const Point& p = points[random(count)];
        rays.row(k) << p.ray_x, p.ray_y, 1.0F;
        w[k] = p.inverse_depth;
      }
      if (std::abs(rays.determinant()) < 1e-4F) continue;
      const Eigen::Vector3f abc = rays.inverse() * w;
      const std::size_t supporters = points_on(abc);
      if (supporters <= most) continue;
      most = supporters;
      best = abc;
    }
    // Through all the points on it rather than three noisy ones.
    Eigen::Matrix3f A = Eigen::Matrix3f::Zero();
    Eigen::Vector3f b = Eigen::Vector3f::Zero();
    for (std::size_t k = 0; k < count; ++k) {
      if (!on(best, points[k])) continue;
      const Eigen::Vector3f ray(points[k].ray_x, points[k].ray_y, 1.0F);
      A += ray * ray.transpose();
      b += ray * points[k].inverse_depth;
    }
    const Eigen::Vector3f fitted = A.ldlt().solve(b);
    const std::size_t fitted_on = points_on(fitted);
    if (fitted_on > most) {
      most = fitted_on;
      best = fitted;
    }
    flat += most;
    const auto end = std::remove_if(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(count),
                                    [&](const Point& p) { return on(best, p); });
    if (most > 0) count = static_cast<std::size_t>(end - points.begin());
  }
  return static_cast<float>(flat) / static_cast<float>(all);
}

}  // namespace armature
