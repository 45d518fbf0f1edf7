#include "tracker/joints/occlusion.h"

#include <algorithm>
#include <cmath>

namespace armature {
namespace {

constexpr double kWindow_m = 0.35;  // to either side of a joint: what votes for it lies as far away
constexpr double kNearer_m = 0.15;  // than the joint: flesh and clothes are not
constexpr double kFloor_m = 0.10;   // what is lower belongs to the floor
constexpr int kMostSamples = 9;     // along a side of the window

/// The share of pixels with depth around a joint that are a stranger's and nearer than it.
float hidden_share(const DepthView& frame, const Segmentation& segmentation, std::uint8_t user,
                   const Eigen::Vector3f& joint) noexcept {
  const Intrinsics& k = frame.intrinsics;
  const double z = joint.z();
  if (!(z > kNearer_m)) return 0;
  const double u = k.centre_x_px + k.focal_x_px * joint.x() / z;
  const double v = k.centre_y_px + k.focal_y_px * joint.y() / z;
  const double half = kWindow_m * k.focal_x_px / z;
  if (!(u > -half && u < k.width + half && v > -half && v < k.height + half)) return 0;
  const double nearer_mm = 1000 * (z - kNearer_m);
  const auto on_floor = [&](int x, int y, std::uint16_t mm) {
    if (!segmentation.floor) return false;
    const double m = 0.001 * mm;
    const Eigen::Vector3d point(m * (x - k.centre_x_px) / k.focal_x_px, m * (y - k.centre_y_px) / k.focal_y_px, m);
    return segmentation.floor->normal.cast<double>().dot(point) + segmentation.floor->offset < kFloor_m;
  };
  int hidden = 0;
  int seen = 0;
  for (int row = 0; row < kMostSamples; ++row) {
    for (int column = 0; column < kMostSamples; ++column) {
      const auto along = [&](int step) { return half * (2.0 * step / (kMostSamples - 1) - 1); };
      const auto x = static_cast<int>(std::lround(u + along(column)));
      const auto y = static_cast<int>(std::lround(v + along(row)));
      if (x < 0 || x >= k.width || y < 0 || y >= k.height) continue;
      const auto pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(k.width) + static_cast<std::size_t>(x);
      const std::uint16_t depth_mm = frame.depth_mm[pixel];
      if (depth_mm == 0) continue;
      ++seen;
      if (segmentation.user_of_pixel[pixel] != user && depth_mm < nearer_mm && !on_floor(x, y, depth_mm)) ++hidden;
    }
  }
  return seen > 0 ? static_cast<float>(hidden) / static_cast<float>(seen) : 0.0F;
}

}  // namespace

void doubt_hidden_joints(DepthView frame, const Segmentation& segmentation, std::uint8_t user,
                         Skeleton& skeleton) noexcept {
  for (Joint& joint : skeleton.joints) {
    if (joint.state == JointState::Lost) continue;
    const float hidden = hidden_share(frame, segmentation, user, joint.position);
    joint.confidence *= std::max(0.0F, 1 - 2 * hidden);
    if (hidden > 0.5F) joint.state = JointState::Inferred;
  }
}

}  // namespace armature
