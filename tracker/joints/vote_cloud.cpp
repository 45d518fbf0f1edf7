#include "tracker/joints/vote_cloud.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace armature {

VoteCloud::VoteCloud(std::size_t capacity)
    : x_(capacity + kLanes), y_(capacity + kLanes), z_(capacity + kLanes), weight_(capacity + kLanes) {}

void VoteCloud::add(const Eigen::Vector3f& position, float weight) noexcept {
  assert(size_ < capacity());
  x_[size_] = position.x();
  y_[size_] = position.y();
  z_[size_] = position.z();
  weight_[size_] = weight;
  ++size_;
}

void VoteCloud::finish() noexcept {
  for (std::size_t i = size_; i < size_ + kLanes; ++i) x_[i] = y_[i] = z_[i] = weight_[i] = 0;
  total_weight_ = 0;
  mean_.setZero();
  for (std::size_t i = 0; i < size_; ++i) {
    mean_ += weight_[i] * Eigen::Vector3f(x_[i], y_[i], z_[i]);
    total_weight_ += weight_[i];
  }
  if (total_weight_ > 0) mean_ /= total_weight_;
}

VoteMode VoteCloud::mode_near(const Eigen::Vector3f& start, float radius_m, int max_steps) const noexcept {
  constexpr float kStill_m = 0.001F;
  const float inverse_radius2 = 1 / (radius_m * radius_m);
  VoteMode mode{start, 0};
  for (int step = 0; step < max_steps; ++step) {
    std::array<float, kLanes> sum_x{}, sum_y{}, sum_z{}, sum{};
    const float cx = mode.position.x(), cy = mode.position.y(), cz = mode.position.z();
    for (std::size_t i = 0; i < size_; i += kLanes) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const float dx = x_[i + lane] - cx;
        const float dy = y_[i + lane] - cy;
        const float dz = z_[i + lane] - cz;
        const float inside = std::max(0.0F, 1 - (dx * dx + dy * dy + dz * dz) * inverse_radius2);
        const float w = weight_[i + lane] * inside * inside;
        sum_x[lane] += w * dx;
        sum_y[lane] += w * dy;
        sum_z[lane] += w * dz;
        sum[lane] += w;
      }
    }
    Eigen::Vector3f shift = Eigen::Vector3f::Zero();
    float mass = 0;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      shift += Eigen::Vector3f(sum_x[lane], sum_y[lane], sum_z[lane]);
      mass += sum[lane];
    }
    mode.mass = mass;
    if (mass <= 0) break;
    shift /= mass;
    mode.position += shift;
    if (shift.squaredNorm() < kStill_m * kStill_m) break;
  }
  return mode;
}

}  // namespace armature
