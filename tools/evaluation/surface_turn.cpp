#include "tools/evaluation/surface_turn.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Dense>

namespace armature::tools {
namespace {

constexpr float kHalfWidth_m = 0.13F;
constexpr float kHalfDepth_m = 0.22F;
constexpr std::size_t kLeastPixels = 30;
constexpr int kRounds = 5;
constexpr double kLeastResidual_m = 0.005;
constexpr double kLeastPivot = 1e-9;  // of the largest

Eigen::Vector3f middle(const Skeleton& skeleton, JointId left, JointId right) noexcept {
  return 0.5F * (skeleton[left].position + skeleton[right].position);
}

/// Metres, camera frame, of the pixels in a box about the strip.
std::vector<Eigen::Vector3d> points_in(const DepthView& frame, std::span<const std::uint8_t> mask,
                                       const TrunkStrip& strip) {
  const Intrinsics& k = frame.intrinsics;
  const auto row_of = [&](const Eigen::Vector3f& p) {
    const float row = k.centre_y_px + k.focal_y_px * p.y() / p.z();
    return static_cast<int>(std::clamp(row, 0.0F, static_cast<float>(k.height - 1)));
  };
  const Eigen::Vector3f centre = 0.5F * (strip.top + strip.bottom);
  std::vector<Eigen::Vector3d> points;
  for (int v = row_of(strip.top); v <= row_of(strip.bottom); ++v) {
    for (int u = 0; u < k.width; ++u) {
      const auto pixel = static_cast<std::size_t>(v) * static_cast<std::size_t>(k.width) + static_cast<std::size_t>(u);
      if (mask[pixel] == 0 || frame.depth_mm[pixel] == 0) continue;
      const float z = 0.001F * static_cast<float>(frame.depth_mm[pixel]);
      const float x = (static_cast<float>(u) - k.centre_x_px) / k.focal_x_px * z;
      if (std::abs(x - centre.x()) >= kHalfWidth_m || std::abs(z - centre.z()) >= kHalfDepth_m) continue;
      points.emplace_back(x, (static_cast<float>(v) - k.centre_y_px) / k.focal_y_px * z, z);
    }
  }
  return points;
}

}  // namespace

TrunkStrip shoulder_strip(const Skeleton& skeleton) noexcept {
  const Eigen::Vector3f shoulders = middle(skeleton, JointId::LeftShoulder, JointId::RightShoulder);
  const Eigen::Vector3f hips = middle(skeleton, JointId::LeftHip, JointId::RightHip);
  return {shoulders - Eigen::Vector3f(0, 0.02F, 0), shoulders + 0.35F * (hips - shoulders)};
}

TrunkStrip hip_strip(const Skeleton& skeleton) noexcept {
  const Eigen::Vector3f shoulders = middle(skeleton, JointId::LeftShoulder, JointId::RightShoulder);
  const Eigen::Vector3f hips = middle(skeleton, JointId::LeftHip, JointId::RightHip);
  return {hips + 0.15F * (shoulders - hips), hips + Eigen::Vector3f(0, 0.08F, 0)};
}

std::optional<double> surface_turn(const DepthView& frame, std::span<const std::uint8_t> mask,
                                   const TrunkStrip& strip) {
  if (!(strip.top.z() > 0 && strip.bottom.z() > 0)) return std::nullopt;
  const std::vector<Eigen::Vector3d> points = points_in(frame, mask, strip);
  if (points.size() < kLeastPixels) return std::nullopt;
  // z = a x + b y + c with the least sum of distances, by weights that are renewed.
  Eigen::Vector3d plane = Eigen::Vector3d::Zero();
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : points) {
      const Eigen::Vector3d row(p.x(), p.y(), 1);
      const double residual = round == 0 ? 0 : std::abs(row.dot(plane) - p.z());
      const double weight = 1 / std::max(residual, kLeastResidual_m);
      normal += weight * row * row.transpose();
      right += weight * p.z() * row;
    }
    const auto factorised = normal.ldlt();
    const Eigen::Vector3d pivots = factorised.vectorD();
    // All of them in one line: any slope would do.
    if (pivots.minCoeff() < kLeastPivot * pivots.maxCoeff()) return std::nullopt;
    plane = factorised.solve(right);
  }
  // Somebody who faces the camera has her left at +x; turned to it, that side is farther away.
  return std::atan(plane.x());
}

}  // namespace armature::tools
