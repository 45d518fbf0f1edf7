#include "sdk/spheremesh/surface_band.h"

#include <algorithm>
#include <limits>

namespace armature::sdk {

using Eigen::Vector3d;

bool SurfaceBand::holds(const Corners& triangle) {
  const Vector3d middle = (triangle[0] + triangle[1] + triangle[2]) / 3;
  double reach = 0;
  for (const Vector3d& corner : triangle) reach = std::max(reach, (corner - middle).norm());
  near_.clear();
  bodies_.find(middle, reach + distance_, near_);
  return holds(triangle, 0);
}

bool SurfaceBand::holds(const Corners& triangle, std::size_t first) {
  const Vector3d middle = (triangle[0] + triangle[1] + triangle[2]) / 3;
  double reach = 0;
  for (const Vector3d& corner : triangle) reach = std::max(reach, (corner - middle).norm());

  double nearest = std::numeric_limits<double>::infinity();
  bool below_all_over = true;   // not deeper than the distance
  bool above_all_over = false;  // not higher
  const std::size_t end = near_.size();
  for (std::size_t k = first; k < end; ++k) {
    const ConvexUnion::BodyId body = near_[k];
    const ConvexUnion::Value v = bodies_.value(body, middle);
    if (v.distance > reach + distance_) continue;
    near_.push_back(body);
    nearest = std::min(nearest, v.distance);
    if (nearest < -distance_) break;
    double least = std::numeric_limits<double>::infinity();
    double most = v.distance;
    for (const Vector3d& corner : triangle) {
      least = std::min(least, v.distance + v.gradient.dot(corner - middle));
      if (!above_all_over && most <= distance_) most = std::max(most, bodies_.distance(body, corner));
    }
    below_all_over &= least >= -distance_;
    above_all_over |= most <= distance_;
  }
  bool held = nearest >= -distance_ && nearest <= distance_ && (nearest >= 0 || comes_out(middle, end));
  constexpr double kFine = 0.1;
  if (held && !(below_all_over && above_all_over) && reach > kFine * distance_) {
    const auto& [a, b, c] = triangle;
    const Vector3d ab = (a + b) / 2;
    const Vector3d bc = (b + c) / 2;
    const Vector3d ca = (c + a) / 2;
    held = holds({ab, bc, ca}, end) && holds({a, ab, ca}, end) && holds({ab, b, bc}, end) && holds({ca, bc, c}, end);
  }
  near_.resize(end);
  return held;
}

bool SurfaceBand::comes_out(const Vector3d& point, std::size_t first) const {
  constexpr int kSteps = 8;
  constexpr double kOut = 0.02;
  Vector3d x = point;
  for (int step = 0; step < kSteps; ++step) {
    ConvexUnion::Value deepest;
    for (std::size_t k = first; k < near_.size(); ++k) {
      const ConvexUnion::Value v = bodies_.value(near_[k], x);
      if (v.distance < deepest.distance) deepest = v;
    }
    if (deepest.distance >= -kOut * distance_) return true;
    x -= deepest.distance * deepest.gradient;
    if ((x - point).squaredNorm() > distance_ * distance_) return false;
  }
  return false;
}

}  // namespace armature::sdk
