#include "tracker/segmentation/user_tracker.h"

#include <algorithm>
#include <cmath>

namespace armature {
namespace {

// What may become a user. Metres; a component may be only the upper body, or cut by the image's edge.
constexpr float kMinBodyArea = 0.13F;
constexpr float kMaxBodyArea = 1.6F;
constexpr float kMinBodyHeight = 0.45F;
constexpr float kMaxBodyHeight = 2.4F;
constexpr float kMaxBodyWidth = 2.1F;
constexpr float kMaxBodyDepth = 1.5F;
constexpr float kMinHeadHeight = 0.95F;  ///< above the floor: a chair's back is lower, a seated person higher
constexpr float kMaxHeadHeight = 2.4F;
constexpr float kMaxFeetHeight = 0.75F;  ///< above the floor, unless cut by the image: what hangs on a wall is higher

constexpr float kMinTrackedArea = 0.04F;  ///< less of a known user is not enough to go on
constexpr float kMaxTrackedArea = 2.5F;   ///< more is a room that has moved, not a user
constexpr float kSameSurface = 0.20F;     ///< metres along z that a user's surface moves in a frame at most
constexpr float kSameBody = 0.40F;        ///< two people's centres are not nearer
constexpr int kMaxMissed = 45;
constexpr float kReach = 1.2F;            ///< from a body's centre to its hands
constexpr float kLimbStep = 0.5F;         ///< depth from a hand to the body behind it
constexpr float kZoneMargin = 0.2F;

constexpr float kMovedDistance = 0.02F;  ///< of the centre: nobody stands stiller, furniture does
constexpr int kFurnitureFrames = 150;

std::size_t at(int i) noexcept { return static_cast<std::size_t>(i); }

float level_distance(const Eigen::Vector3f& a, const Eigen::Vector3f& b) noexcept {
  return std::hypot(a.x() - b.x(), a.z() - b.z());
}

}  // namespace

UserTracker::UserTracker(const SegmentationOptions& options, int cells)
    : options_(options),
      owners_(at(cells)),
      dismissed_(at(cells)),
      previous_owners_(at(cells)),
      previous_depth_(at(cells)) {
  queue_.reserve(at(cells));
}

void UserTracker::update(const DepthGrid& grid, const ComponentFinder& components,
                         const std::optional<FloorPlane>& floor) noexcept {
  const auto found = components.components();
  const auto labels = components.labels();
  owner_of_.fill(kNobody);
  count_overlaps(grid, labels);
  keep(found);
  admit(found, floor);
  attach(components);
  share(grid, labels);
  move(grid);
  dismiss_furniture();
  std::ranges::copy(owners_, previous_owners_.begin());
  std::ranges::copy(grid.depth, previous_depth_.begin());
}

bool UserTracker::in_zone(const Component& c, float margin) const noexcept {
  return std::abs(c.centre.x()) <= options_.half_width_m + margin;
}

bool UserTracker::human_sized(const Component& c, const std::optional<FloorPlane>& floor) const noexcept {
  if (c.area < kMinBodyArea || c.area > kMaxBodyArea) return false;
  if (c.height() < kMinBodyHeight || c.height() > kMaxBodyHeight) return false;
  if (c.width() > kMaxBodyWidth || c.far - c.near > kMaxBodyDepth) return false;
  if (!floor) return true;
  const float head = c.highest + floor->offset;
  const float feet = c.lowest + floor->offset;
  if (!c.cut_above && (head < kMinHeadHeight || head > kMaxHeadHeight)) return false;
  return c.cut_below || feet < kMaxFeetHeight;
}

void UserTracker::count_overlaps(const DepthGrid& grid, std::span<const std::uint8_t> labels) noexcept {
  for (auto& row : overlap_) row.fill(0);
  previous_cells_.fill(0);
  for (int i = 0; i < grid.size(); ++i) {
    const std::uint8_t owner = previous_owners_[at(i)];
    if (owner == kNobody) continue;
    ++previous_cells_[owner - std::size_t{1}];
    if (labels[at(i)] == 0 || std::abs(grid.depth[at(i)] - previous_depth_[at(i)]) > kSameSurface) continue;
    ++overlap_[labels[at(i)] - std::size_t{1}][owner - std::size_t{1}];
  }
}

void UserTracker::keep(std::span<const Component> found) noexcept {
  for (std::size_t t = 0; t < kMaxUsers; ++t) {
    Track& track = tracks_[t];
    if (!track.seen()) continue;
    // Her main component first; then others that hold a good part of her, unless another body has stepped out of it.
    std::size_t main = kMaxComponents;
    for (std::size_t c = 0; c < found.size(); ++c)
      if (overlap_[c][t] > 0 && (main == kMaxComponents || overlap_[c][t] > overlap_[main][t])) main = c;
    if (main == kMaxComponents || overlap_[main][t] * 10 < previous_cells_[t]) continue;
    if (!in_zone(found[main], kZoneMargin) || found[main].area > kMaxTrackedArea) continue;
    const auto give = [&](std::size_t c) {
      owner_of_[c] = owner_of_[c] == kNobody ? static_cast<std::uint8_t>(t + 1) : kShared;
    };
    give(main);
    for (std::size_t c = 0; c < found.size(); ++c) {
      if (c == main || overlap_[c][t] * 3 < found[c].cells || overlap_[c][t] * 20 < previous_cells_[t]) continue;
      if (level_distance(found[c].centre, found[main].centre) < kSameBody) give(c);
    }
  }
}

std::size_t UserTracker::place_for(const Component& c) noexcept {
  // Somebody who was lost near here, else a free place, else that of whoever has been gone longest.
  std::size_t best = kMaxUsers;
  float best_distance = 0;
  for (std::size_t t = 0; t < kMaxUsers; ++t) {
    const Track& track = tracks_[t];
    if (track.id == 0 || std::ranges::find(owner_of_, t + 1) != owner_of_.end()) continue;
    const float waited = static_cast<float>(track.missed + 1);
    const Eigen::Vector3f expected = track.centre + std::min(waited, 10.0F) * track.velocity;
    const float distance = std::min(level_distance(expected, c.centre), level_distance(track.centre, c.centre));
    if (distance > std::min(0.4F + 0.04F * waited, 1.2F)) continue;
    if (best < kMaxUsers && distance >= best_distance) continue;
    best = t;
    best_distance = distance;
  }
  if (best < kMaxUsers) return best;
  for (std::size_t t = 0; t < kMaxUsers; ++t)
    if (tracks_[t].id == 0) return t;
  for (std::size_t t = 0; t < kMaxUsers; ++t) {
    if (std::ranges::find(owner_of_, t + 1) != owner_of_.end() || tracks_[t].missed == 0) continue;
    if (best == kMaxUsers || tracks_[t].missed > tracks_[best].missed) best = t;
  }
  if (best < kMaxUsers) tracks_[best] = {};
  return best;
}

void UserTracker::admit(std::span<const Component> found, const std::optional<FloorPlane>& floor) noexcept {
  // Components come largest first in the image.
  for (std::size_t c = 0; c < found.size(); ++c) {
    if (owner_of_[c] != kNobody || !in_zone(found[c], 0) || !human_sized(found[c], floor)) continue;
    bool part_of_somebody = false;
    for (std::size_t other = 0; other < found.size() && !part_of_somebody; ++other) {
      if (owner_of_[other] == kNobody || owner_of_[other] == kShared) continue;
      if (level_distance(found[other].centre, found[c].centre) >= kSameBody) continue;
      owner_of_[c] = owner_of_[other];
      part_of_somebody = true;
    }
    if (part_of_somebody) continue;
    const std::size_t t = place_for(found[c]);
    if (t == kMaxUsers) continue;
    if (tracks_[t].id == 0) {
      last_id_ = static_cast<std::uint8_t>(last_id_ % 250 + 1);
      while (std::ranges::find(tracks_, last_id_, &Track::id) != tracks_.end())
        last_id_ = static_cast<std::uint8_t>(last_id_ % 250 + 1);
      tracks_[t] = {};
      tracks_[t].id = last_id_;
      tracks_[t].birthplace = found[c].centre;
    }
    tracks_[t].centre = found[c].centre;
    tracks_[t].velocity.setZero();
    owner_of_[c] = static_cast<std::uint8_t>(t + 1);
  }
}

void UserTracker::attach(const ComponentFinder& components) noexcept {
  // Hands in front of the body, a shin below something, the far side of an arm: pieces beside somebody and within her
  // reach. Two rounds, for a hand is held by a forearm.
  const auto found = components.components();
  for (int round = 0; round < 2; ++round) {
    const auto before = owner_of_;
    for (std::size_t c = 0; c < found.size(); ++c) {
      if (before[c] != kNobody) continue;
      float best_step = kLimbStep;
      for (std::size_t body = 0; body < found.size(); ++body) {
        if (before[body] == kNobody || before[body] == kShared) continue;
        const Contact& contact = components.contact(c, body);
        if (contact.cells == 0 || contact.smallest_step >= best_step) continue;
        const Track& track = tracks_[before[body] - std::size_t{1}];
        if ((found[c].centre - track.centre).norm() > kReach) continue;
        const bool was_not_there = found[c].foreground_cells * 2 > found[c].cells;
        const bool before_body = found[c].centre.z() < found[body].centre.z() + 0.05F;
        const bool beside_body = contact.smallest_step < 0.2F;
        const float most = was_not_there ? 0.3F : before_body ? 0.12F : beside_body ? 0.05F : 0.0F;
        if (found[c].area > most) continue;
        best_step = contact.smallest_step;
        owner_of_[c] = before[body];
      }
    }
  }
}

void UserTracker::share(const DepthGrid& grid, std::span<const std::uint8_t> labels) noexcept {
  // Where users have met in one component, each keeps what was hers and they grow towards each other.
  queue_.clear();
  for (int i = 0; i < grid.size(); ++i) {
    const std::uint8_t label = labels[at(i)];
    std::uint8_t owner = label == 0 ? kNobody : owner_of_[label - std::size_t{1}];
    if (owner == kShared) {
      const std::uint8_t was = previous_owners_[at(i)];
      const bool still = was != kNobody && std::abs(grid.depth[at(i)] - previous_depth_[at(i)]) <= kSameSurface;
      owner = still ? was : kNobody;
      if (still) queue_.push_back(i);
    }
    owners_[at(i)] = owner;
  }
  const int w = grid.width;
  for (std::size_t head = 0; head < queue_.size(); ++head) {
    const int i = queue_[head];
    const int x = i % w;
    const int y = i / w;
    const auto grow = [&](int j) {
      if (labels[at(j)] != labels[at(i)] || owners_[at(j)] != kNobody) return;
      owners_[at(j)] = owners_[at(i)];
      queue_.push_back(j);
    };
    if (x > 0) grow(i - 1);
    if (x + 1 < w) grow(i + 1);
    if (y > 0) grow(i - w);
    if (y + 1 < grid.height) grow(i + w);
  }
}

void UserTracker::move(const DepthGrid& grid) noexcept {
  std::array<Eigen::Vector3f, kMaxUsers> sum;
  std::array<int, kMaxUsers> cells{};
  std::array<float, kMaxUsers> area{};
  sum.fill(Eigen::Vector3f::Zero());
  for (int y = 0, i = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x, ++i) {
      if (owners_[at(i)] == kNobody) continue;
      const std::size_t t = owners_[at(i)] - std::size_t{1};
      const float z = grid.depth[at(i)];
      sum[t] += Eigen::Vector3f(grid.ray_x[at(x)] * z, grid.ray_y[at(y)] * z, z);
      area[t] += grid.area(z);
      ++cells[t];
    }
  }
  std::array<bool, kMaxUsers> gone{};
  for (std::size_t t = 0; t < kMaxUsers; ++t) {
    Track& track = tracks_[t];
    if (track.id == 0) continue;
    if (area[t] < kMinTrackedArea) {
      gone[t] = cells[t] > 0;
      if (++track.missed > kMaxMissed) track = {};
      continue;
    }
    const Eigen::Vector3f centre = sum[t] / static_cast<float>(cells[t]);
    if (track.age > 0 && track.missed == 0) track.velocity += 0.3F * (centre - track.centre - track.velocity);
    track.centre = centre;
    track.area = area[t];
    track.missed = 0;
    ++track.age;
    track.has_moved |= (centre - track.birthplace).norm() > kMovedDistance;
  }
  if (std::ranges::find(gone, true) == gone.end()) return;
  for (std::uint8_t& owner : owners_)
    if (owner != kNobody && gone[owner - std::size_t{1}]) owner = kNobody;
}

void UserTracker::dismiss_furniture() noexcept {
  // Something that has stood still ever since the first frames is only taken for a person while nobody moves.
  std::ranges::fill(dismissed_, std::uint8_t{0});
  const bool somebody_moves =
      std::ranges::any_of(tracks_, [](const Track& track) { return track.seen() && track.has_moved; });
  if (!somebody_moves) return;
  for (std::size_t t = 0; t < kMaxUsers; ++t) {
    if (!tracks_[t].seen() || tracks_[t].has_moved || tracks_[t].age < kFurnitureFrames) continue;
    tracks_[t] = {};
    for (std::size_t i = 0; i < owners_.size(); ++i) {
      if (owners_[i] != t + 1) continue;
      owners_[i] = kNobody;
      dismissed_[i] = 1;
    }
  }
}

}  // namespace armature
