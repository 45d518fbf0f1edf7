#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tracker/segmentation/depth_grid.h"

namespace armature {

/// What stands behind everybody: per cell the farthest surface that has stayed, learned while no user covers it.
/// Something farther than what was believed is believed at once (nobody can stand behind the background); something
/// nearer only after it has stood still for seconds. Realtime-safe: yes, all but the constructor.
class BackgroundModel {
 public:
  enum class Cell : std::uint8_t { Unknown, Background, Foreground };

  /// What a cell turned out to be covered by.
  enum class Cover : std::uint8_t {
    Nobody,
    User,
    Furniture,  ///< taken for a user until now: believed to be background at once
  };

  explicit BackgroundModel(int cells);

  /// What a cell of this frame shows. A cell without a return is Unknown.
  [[nodiscard]] Cell classify(std::size_t cell, float inverse_depth) const noexcept {
    if (inverse_depth <= 0 || seen_[cell] < kKnown) return Cell::Unknown;
    const float behind = inverse_depth_[cell];
    return inverse_depth > behind + tolerance(behind) ? Cell::Foreground : Cell::Background;
  }

  /// Cells that are looked at together, in vector registers: nearly always they show nothing new.
  static constexpr std::size_t kBlock = 16;
  /// Whether each of the kBlock cells from `first` on has no return or is Background.
  [[nodiscard]] bool nothing_new(std::size_t first, std::span<const float> inverse_depth) const noexcept;

  /// Believes what was seen of the empty site; cells of 0 stay as they are.
  void adopt(std::span<const float> inverse_depth) noexcept;

  /// Learns from a frame, never from the cells of users.
  void learn(const DepthGrid& grid, std::span<const Cover> cover) noexcept;

 private:
  static constexpr int kKnown = 15;  ///< frames that make a surface background where nothing was known
  /// How far two measurements of one surface lie apart at most, 1/m.
  [[nodiscard]] static constexpr float tolerance(float inverse_depth) noexcept {
    return 2.5F * kDisparityStep + 0.02F * inverse_depth;
  }
  struct Entry {
    float inverse_depth = 0;
    int seen = 0;
  };
  void believe(std::size_t cell, Entry entry) noexcept;
  [[nodiscard]] bool settled(std::size_t first, std::span<const float> inverse_depth,
                             std::span<const Cover> cover) const noexcept;
  void refresh(std::size_t first, std::span<const float> inverse_depth) noexcept;
  [[nodiscard]] bool learn_cell(std::size_t cell, float inverse_depth, Cover cover) noexcept;

  std::vector<float> inverse_depth_;  ///< 0 = nothing within the sensor's range
  std::vector<float> candidate_;      ///< another surface that might be taking its place
  std::vector<std::int32_t> seen_;    ///< frames that confirmed it, saturating at kKnown
  std::vector<std::int32_t> candidate_seen_;
  int moved_frames_ = 0;
};

}  // namespace armature
