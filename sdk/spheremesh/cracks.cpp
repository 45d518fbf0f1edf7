#include "sdk/spheremesh/cracks.h"

#include <cmath>

namespace armature::sdk {

using Eigen::Vector3d;

bool Cracks::find(const Vector3d& point, ConvexUnion::BodyId& body) {
  near_.clear();
  bodies_.find(point, tolerance_, near_);
  if (near_.empty()) return false;
  body = bodies_.nearest(near_, point);
  return true;
}

double Cracks::distance(const Vector3d& point) {
  near_.clear();
  bodies_.find(point, 4 * tolerance_, near_);
  return bodies_.distance(near_, point);
}

double Cracks::cosine(const Vector3d& a, const Vector3d& b) {
  ConvexUnion::BodyId of_a = 0;
  ConvexUnion::BodyId of_b = 0;
  if (!find(a, of_a) || !find(b, of_b) || of_a == of_b || !(distance((a + b) / 2) > 0)) return 1;
  return bodies_.value(of_a, a).gradient.dot(bodies_.value(of_b, b).gradient);
}

std::optional<Vector3d> Cracks::bottom(const Vector3d& a, const Vector3d& b) {
  constexpr int kSteps = 40;
  constexpr double kDeepest = 60;  // in tolerances
  constexpr double kThere = 1e-4;
  ConvexUnion::BodyId of_a = 0;
  ConvexUnion::BodyId of_b = 0;
  if (!find(a, of_a) || !find(b, of_b)) return std::nullopt;
  const Vector3d start = (a + b) / 2;
  // Newton's method: to the line where both tangent planes meet. Where walls touch it halves what is left.
  Vector3d x = start;
  bool there = false;
  for (int step = 0; step < kSteps && !there; ++step) {
    there = std::abs(bodies_.distance(of_a, x)) < kThere * tolerance_ &&
            std::abs(bodies_.distance(of_b, x)) < kThere * tolerance_;
    x += bodies_.to_crease(of_a, of_b, x);
    if (!((x - start).squaredNorm() < kDeepest * kDeepest * tolerance_ * tolerance_)) return std::nullopt;
  }
  if (!there) return std::nullopt;
  // As far down as the cleft is free.
  constexpr int kHalvings = 12;
  constexpr double kFree = -0.01;
  constexpr int kLooks = 4;
  double free = 0;
  double filled = 1;
  for (int look = 1; look <= kLooks; ++look) {
    const double along = static_cast<double>(look) / kLooks;
    if (distance(start + along * (x - start)) < kFree * tolerance_) {
      filled = along;
      for (int k = 0; k < kHalvings; ++k) {
        const double between = (free + filled) / 2;
        (distance(start + between * (x - start)) < kFree * tolerance_ ? filled : free) = between;
      }
      return start + free * (x - start);
    }
    free = along;
  }
  return x;
}

}  // namespace armature::sdk
