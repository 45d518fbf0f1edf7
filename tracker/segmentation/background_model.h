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
  [[nodiscard]] Cell classify(int cell, float inverse_depth) const noexcept;

  /// Learns from a frame, never from the cells of users.
  void learn(const DepthGrid& grid, std::span<const Cover> cover) noexcept;

 private:
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
