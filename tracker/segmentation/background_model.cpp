#include "tracker/segmentation/background_model.h"

#include <algorithm>
#include <cmath>

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

BackgroundModel::BackgroundModel(int cells) : entries_(static_cast<std::size_t>(cells)) {}

void BackgroundModel::learn(const DepthGrid& grid, std::span<const Cover> cover) noexcept {
  std::size_t farther = 0;
  std::size_t known = 0;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    Entry& e = entries_[i];
    const float w = grid.inverse_depth[i];
    const bool is_known = e.seen >= kKnown;
    known += is_known;
    if (cover[i] == Cover::User) {
      e.candidate_seen = 0;
      continue;
    }
    if (cover[i] == Cover::Furniture && w > 0) {
      e = {w, 0, kKnown, 0};
      continue;
    }
    if (!is_known) {
      if (w <= 0) {
        // Counted down from zero in `candidate_seen`, so that one return starts afresh.
        if (e.seen == 0 && ++e.candidate_seen >= kKnownEmpty) e = {0, 0, kKnown, 0};
        continue;
      }
      if (e.seen > 0 && std::abs(w - e.inverse_depth) <= tolerance(e.inverse_depth)) {
        ++e.seen;
        e.inverse_depth += (w - e.inverse_depth) / static_cast<float>(e.seen);
      } else {
        e = {w, 0, 1, 0};
      }
      continue;
    }
    if (w <= 0) continue;
    const float difference = w - e.inverse_depth;
    if (e.inverse_depth > 0 && std::abs(difference) <= tolerance(e.inverse_depth)) {
      e.inverse_depth += kLearningRate * difference;
      e.candidate_seen = 0;
      continue;
    }
    farther += difference < 0;
    const bool same = e.candidate_seen > 0 && std::abs(w - e.candidate) <= tolerance(e.candidate);
    e.candidate = same ? e.candidate + kLearningRate * (w - e.candidate) : w;
    e.candidate_seen = static_cast<std::uint16_t>(same ? e.candidate_seen + 1 : 1);
    const int needed = difference < 0 ? kFarther : e.inverse_depth > 0 ? kNearer : kNearerThanNothing;
    if (e.candidate_seen >= needed) e = {e.candidate, 0, kKnown, 0};
  }
  const bool moved =
      known > entries_.size() / 10 && static_cast<float>(farther) > kMovedShare * static_cast<float>(known);
  moved_frames_ = moved ? moved_frames_ + 1 : 0;
  if (moved_frames_ >= kMovedFrames) {
    std::ranges::fill(entries_, Entry{});
    moved_frames_ = 0;
  }
}

}  // namespace armature
