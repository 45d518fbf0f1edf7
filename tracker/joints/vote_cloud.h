#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace armature {

/// A mode of a cloud of weighted votes.
struct VoteMode {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< metres
  float mass = 0;  ///< sum of the votes' weights, each by the kernel of its distance
};

/// The votes for one joint. Keeps at most `capacity` of them; add() beyond that is the caller's mistake.
/// Realtime-safe: everything but the constructor.
class VoteCloud {
 public:
  explicit VoteCloud(std::size_t capacity);

  void clear() noexcept { size_ = 0; }
  void add(const Eigen::Vector3f& position, float weight) noexcept {
    assert(size_ < capacity_);
    Block& block = blocks_[size_ / kLanes];
    const std::size_t lane = size_ % kLanes;
    block.x[lane] = position.x();
    block.y[lane] = position.y();
    block.z[lane] = position.z();
    block.weight[lane] = weight;
    ++size_;
  }
  /// After the last add(), before anything below.
  void finish() noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] std::size_t capacity() const noexcept { return capacity_; }
  [[nodiscard]] float total_weight() const noexcept { return total_weight_; }
  [[nodiscard]] const Eigen::Vector3f& mean() const noexcept { return mean_; }

  /// Mean shift from `start` with the kernel (1 - d^2/radius^2)^2, zero beyond the radius, until it moves by less than
  /// a millimetre. Where no vote is within the radius, the result is `start` with no mass.
  [[nodiscard]] VoteMode mode_near(const Eigen::Vector3f& start, float radius_m, int max_steps) const noexcept;

  /// Sums run in this many lanes, in a fixed order: fast without a compiler's leave to reorder them.
  static constexpr std::size_t kLanes = 8;
  struct Block {
    std::array<float, kLanes> x, y, z, weight;
  };

 private:
  std::vector<Block> blocks_;
  std::size_t capacity_ = 0;
  std::size_t size_ = 0;
  float total_weight_ = 0;
  Eigen::Vector3f mean_ = Eigen::Vector3f::Zero();
};

}  // namespace armature
