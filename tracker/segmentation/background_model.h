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
    const Entry& e = entries_[cell];
    if (inverse_depth <= 0 || e.seen < kKnown) return Cell::Unknown;
    return inverse_depth > e.inverse_depth + tolerance(e.inverse_depth) ? Cell::Foreground : Cell::Background;
  }

  /// Learns from a frame, never from the cells of users.
  void learn(const DepthGrid& grid, std::span<const Cover> cover) noexcept;

 private:
  static constexpr int kKnown = 15;  ///< frames that make a surface background where nothing was known
  /// How far two measurements of one surface lie apart at most, 1/m.
  [[nodiscard]] static constexpr float tolerance(float inverse_depth) noexcept {
    return 2.5F * kDisparityStep + 0.02F * inverse_depth;
  }
  struct Entry {
    float inverse_depth = 0;  ///< 0 = nothing within the sensor's range
    float candidate = 0;      ///< another surface that might be taking its place
    std::uint16_t seen = 0;   ///< frames that confirmed it, saturating at kKnown
    std::uint16_t candidate_seen = 0;
  };
  std::vector<Entry> entries_;
  int moved_frames_ = 0;
};

}  // namespace armature
