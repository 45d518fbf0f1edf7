#include "tracker/segmentation/background_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace armature {
namespace {

constexpr int kKnownEmpty = 90;  ///< the same for the absence of any return: shadows are empty too
constexpr int kFarther = 3;      ///< frames until something farther is believed
constexpr int kNearer = 300;     ///< frames until something nearer is believed
constexpr int kNearerThanNothing = 60;
constexpr float kLearningRate = 0.05F;

// A camera that has been moved shows something farther than the background nearly everywhere.
constexpr float kMovedShare = 0.25F;
constexpr int kMovedFrames = 5;

}  // namespace

BackgroundModel::BackgroundModel(int cells)
    : inverse_depth_(static_cast<std::size_t>(cells)),
      candidate_(static_cast<std::size_t>(cells)),
      seen_(static_cast<std::size_t>(cells)),
      candidate_seen_(static_cast<std::size_t>(cells)) {}

bool BackgroundModel::nothing_new(std::size_t first, std::span<const float> inverse_depth) const noexcept {
  int news = 0;
  for (std::size_t i = first; i < first + kBlock; ++i) {
    const float w = inverse_depth[i], behind = inverse_depth_[i];
    news |= static_cast<int>(w > 0) &
            (static_cast<int>(seen_[i] < kKnown) | static_cast<int>(w > behind + tolerance(behind)));
  }
  return news == 0;
}

/// Whether the cells of a block show what is known to be there, or nothing, and nobody covers them.
bool BackgroundModel::settled(std::size_t first, std::span<const float> inverse_depth,
                              std::span<const Cover> cover) const noexcept {
  int unsettled = 0;
  for (std::size_t i = first; i < first + kBlock; ++i) {
    const float w = inverse_depth[i], behind = inverse_depth_[i];
    const int same = static_cast<int>(behind > 0) & static_cast<int>(std::abs(w - behind) <= tolerance(behind));
    unsettled |= static_cast<int>(seen_[i] < kKnown) | (static_cast<int>(w > 0) & (1 - same));
  }
  static_assert(Cover{} == Cover::Nobody && sizeof(Cover) == 1);
  const std::array<Cover, kBlock> nobody{};
  return unsettled == 0 && std::memcmp(&cover[first], nobody.data(), kBlock) == 0;
}

void BackgroundModel::refresh(std::size_t first, std::span<const float> inverse_depth) noexcept {
  for (std::size_t i = first; i < first + kBlock; ++i) {
    const float w = inverse_depth[i], behind = inverse_depth_[i];
    inverse_depth_[i] = w > 0 ? behind + kLearningRate * (w - behind) : behind;
    candidate_seen_[i] = w > 0 ? 0 : candidate_seen_[i];
  }
}

void BackgroundModel::believe(std::size_t cell, Entry entry) noexcept {
  inverse_depth_[cell] = entry.inverse_depth;
  seen_[cell] = entry.seen;
  candidate_[cell] = 0;
  candidate_seen_[cell] = 0;
}

/// True where a known cell shows something farther than what was believed.
bool BackgroundModel::learn_cell(std::size_t cell, float w, Cover cover) noexcept {
  float& behind = inverse_depth_[cell];
  std::int32_t& seen = seen_[cell];
  float& candidate = candidate_[cell];
  std::int32_t& candidate_seen = candidate_seen_[cell];
  if (cover == Cover::User) {
    candidate_seen = 0;
    return false;
  }
  if (cover == Cover::Furniture && w > 0) {
    believe(cell, {w, kKnown});
    return false;
  }
  if (seen < kKnown) {
    if (w <= 0) {
      // Counted down from zero in `candidate_seen`, so that one return starts afresh.
      if (seen == 0 && ++candidate_seen >= kKnownEmpty) believe(cell, {0, kKnown});
    } else if (seen > 0 && std::abs(w - behind) <= tolerance(behind)) {
      ++seen;
      behind += (w - behind) / static_cast<float>(seen);
    } else {
      believe(cell, {w, 1});
    }
    return false;
  }
  if (w <= 0) return false;
  const float difference = w - behind;
  if (behind > 0 && std::abs(difference) <= tolerance(behind)) {
    behind += kLearningRate * difference;
    candidate_seen = 0;
    return false;
  }
  const bool same = candidate_seen > 0 && std::abs(w - candidate) <= tolerance(candidate);
  candidate = same ? candidate + kLearningRate * (w - candidate) : w;
  candidate_seen = same ? candidate_seen + 1 : 1;
  const int needed = difference < 0 ? kFarther : behind > 0 ? kNearer : kNearerThanNothing;
  if (candidate_seen >= needed) believe(cell, {candidate, kKnown});
  return difference < 0;
}

void BackgroundModel::adopt(std::span<const float> inverse_depth) noexcept {
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    if (inverse_depth[i] > 0) believe(i, {inverse_depth[i], kKnown});
  }
}

void BackgroundModel::learn(const DepthGrid& grid, std::span<const Cover> cover) noexcept {
  const std::span<const float> inverse_depth = grid.inverse_depth;
  std::size_t farther = 0;
  std::size_t known = 0;
  for (std::size_t i = 0; i < seen_.size();) {
    if (i + kBlock <= seen_.size() && settled(i, inverse_depth, cover)) {
      refresh(i, inverse_depth);
      known += kBlock;
      i += kBlock;
      continue;
    }
    for (const std::size_t end = std::min(i + kBlock, seen_.size()); i < end; ++i) {
      known += seen_[i] >= kKnown ? 1 : 0;
      farther += learn_cell(i, inverse_depth[i], cover[i]) ? 1 : 0;
    }
  }
  const bool moved = known > seen_.size() / 10 && static_cast<float>(farther) > kMovedShare * static_cast<float>(known);
  moved_frames_ = moved ? moved_frames_ + 1 : 0;
  if (moved_frames_ >= kMovedFrames) {
    for (std::size_t i = 0; i < seen_.size(); ++i) believe(i, {});
    moved_frames_ = 0;
  }
}

}  // namespace armature
