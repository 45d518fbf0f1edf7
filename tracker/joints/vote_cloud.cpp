#include "tracker/joints/vote_cloud.h"

#include <algorithm>
#include <span>

namespace armature {
namespace {

using Block = VoteCloud::Block;
constexpr std::size_t kLanes = VoteCloud::kLanes;

/// A step of the mean shift: sums over the votes about a centre, each by the kernel of its distance.
struct KernelSums {
  std::array<float, kLanes> x{}, y{}, z{}, weight{};
};

/// Lane by lane: registers of any width give the same bits.
[[gnu::always_inline]] inline void add_votes(std::span<const Block> blocks, const Eigen::Vector3f& centre,
                                             float inverse_radius2, KernelSums& sums) {
  const float cx = centre.x(), cy = centre.y(), cz = centre.z();
  KernelSums s;
  for (const Block& block : blocks) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const float dx = block.x[lane] - cx;
      const float dy = block.y[lane] - cy;
      const float dz = block.z[lane] - cz;
      const float inside = std::max(0.0F, 1 - (dx * dx + dy * dy + dz * dz) * inverse_radius2);
      const float w = block.weight[lane] * inside * inside;
      s.x[lane] += w * dx;
      s.y[lane] += w * dy;
      s.z[lane] += w * dz;
      s.weight[lane] += w;
    }
  }
  sums = s;
}

void add_votes_plain(std::span<const Block> blocks, const Eigen::Vector3f& centre, float inverse_radius2,
                     KernelSums& sums) {
  add_votes(blocks, centre, inverse_radius2, sums);
}
#if defined(__x86_64__)
[[gnu::target("avx2")]] void add_votes_avx2(std::span<const Block> blocks, const Eigen::Vector3f& centre,
                                            float inverse_radius2, KernelSums& sums) {
  add_votes(blocks, centre, inverse_radius2, sums);
}
bool has_avx2() {
  return __builtin_cpu_supports("avx2") != 0;
}
#else
constexpr auto add_votes_avx2 = add_votes_plain;
bool has_avx2() {
  return false;
}
#endif

}  // namespace

VoteCloud::VoteCloud(std::size_t capacity) : blocks_((capacity + kLanes - 1) / kLanes), capacity_(capacity) {}

void VoteCloud::finish() noexcept {
  total_weight_ = 0;
  mean_.setZero();
  for (std::size_t i = 0; i < size_; ++i) {
    const Block& block = blocks_[i / kLanes];
    const std::size_t lane = i % kLanes;
    mean_ += block.weight[lane] * Eigen::Vector3f(block.x[lane], block.y[lane], block.z[lane]);
    total_weight_ += block.weight[lane];
  }
  if (total_weight_ > 0) mean_ /= total_weight_;
  for (std::size_t i = size_; i % kLanes != 0; ++i) {
    Block& block = blocks_[i / kLanes];
    block.x[i % kLanes] = block.y[i % kLanes] = block.z[i % kLanes] = block.weight[i % kLanes] = 0;
  }
}

VoteMode VoteCloud::mode_near(const Eigen::Vector3f& start, float radius_m, int max_steps) const noexcept {
  constexpr float kStill_m = 0.001F;
  const float inverse_radius2 = 1 / (radius_m * radius_m);
  const auto blocks = std::span(blocks_).first((size_ + kLanes - 1) / kLanes);
  const auto add_up = has_avx2() ? add_votes_avx2 : add_votes_plain;
  VoteMode mode{start, 0};
  for (int step = 0; step < max_steps; ++step) {
    KernelSums sums;
    add_up(blocks, mode.position, inverse_radius2, sums);
    Eigen::Vector3f shift = Eigen::Vector3f::Zero();
    float mass = 0;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      shift += Eigen::Vector3f(sums.x[lane], sums.y[lane], sums.z[lane]);
      mass += sums.weight[lane];
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
