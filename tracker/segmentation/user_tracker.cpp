#include "tracker/segmentation/user_tracker.h"

#include <algorithm>
#include <cmath>

#include "tracker/segmentation/human_shape.h"

namespace armature {
namespace {

constexpr float kMinValley = 0.12F;  ///< from the lower head to the shoulders between them
constexpr int kMaxId = 250;
constexpr float kMinTrackedArea = 0.04F;  ///< less of a known user is not enough to go on
constexpr float kMaxTrackedArea = 2.5F;   ///< more is a room that has moved, not a user
constexpr float kSameSurface = 0.20F;     ///< metres along z that a user's surface moves in a frame at most
constexpr float kSameBody = 0.40F;        ///< two people's centres are not nearer
constexpr int kMaxMissed = 45;
constexpr float kReach = 1.2F;     ///< from a body's centre to its hands
constexpr float kLimbStep = 0.5F;  ///< depth from a hand to the body behind it
constexpr float kZoneMargin = 0.2F;

// Furniture never moves; a person's centre or outline does sooner or later.
constexpr float kMovedDistance = 0.02F;
constexpr float kMovedShare = 0.05F;  ///< of the cells, since birth
constexpr int kFurnitureFrames = 600;

std::size_t at(int i) noexcept {
  return static_cast<std::size_t>(i);
}

float level_distance(const Eigen::Vector3f& a, const Eigen::Vector3f& b) noexcept {
  return std::hypot(a.x() - b.x(), a.z() - b.z());
}

}  // namespace

UserTracker::UserTracker(const SegmentationOptions& options, int cells)
    : options_(options),
      owners_(at(cells)),
      dismissed_(at(cells)),
      previous_owners_(at(cells)),
      previous_depth_(at(cells)),
      owners_at_birth_(at(cells)),
      depth_at_birth_(at(cells)) {
  queue_.reserve(at(cells));
}

void UserTracker::update(const DepthGrid& grid, const ComponentFinder& components,
                         const std::optional<FloorPlane>& floor) noexcept {
  const auto found = components.components();
  const auto labels = components.labels();
  owner_of_.fill(kNobody);
  taken_.fill(false);
  count_overlaps(grid, labels);
  keep(found);
  admit(grid, components, floor);
  attach(grid, components, floor);
  share(grid, labels);
  move(grid);
  remember_birth(grid);
  dismiss_furniture();
  std::ranges::copy(owners_, previous_owners_.begin());
  std::ranges::copy(grid.depth, previous_depth_.begin());
}

bool UserTracker::still_user(std::size_t cell, float depth) const noexcept {
  return owners_[cell] != kNobody && std::abs(depth - previous_depth_[cell]) <= kSameSurface;
}

bool UserTracker::in_zone(const Component& c, float margin) const noexcept {
  return std::abs(c.centre.x()) <= options_.half_width_m + margin;
}

void UserTracker::count_overlaps(const DepthGrid& grid, std::span<const std::uint8_t> labels) noexcept {
  for (auto& row : overlap_) row.fill(0);
  previous_cells_.fill(0);
  for_each_marked(grid, previous_owners_, [&](int, int, std::size_t i) {
    const std::uint8_t owner = previous_owners_[i];
    ++previous_cells_[owner - std::size_t{1}];
    if (labels[i] == 0 || std::abs(grid.depth[i] - previous_depth_[i]) > kSameSurface) return;
    ++overlap_[labels[i] - std::size_t{1}][owner - std::size_t{1}];
  });
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
    taken_[t] = true;
    for (std::size_t c = 0; c < found.size(); ++c) {
      if (c == main || overlap_[c][t] * 3 < found[c].cells || overlap_[c][t] * 10 < previous_cells_[t]) continue;
      if (level_distance(found[c].centre, found[main].centre) < kSameBody) give(c);
    }
  }
}

std::size_t UserTracker::place_for(const Eigen::Vector3f& centre) noexcept {
  // Somebody who was lost near here, else a free place, else that of whoever has been gone longest.
  std::size_t best = kMaxUsers;
  float best_distance = 0;
  for (std::size_t t = 0; t < kMaxUsers; ++t) {
    const Track& track = tracks_[t];
    if (track.id == 0 || taken_[t]) continue;
    const float waited = static_cast<float>(track.missed + 1);
    const Eigen::Vector3f expected = track.centre + std::min(waited, 10.0F) * track.velocity;
    const float distance = std::min(level_distance(expected, centre), level_distance(track.centre, centre));
    if (distance > std::min(0.4F + 0.04F * waited, 1.2F)) continue;
    if (best < kMaxUsers && distance >= best_distance) continue;
    best = t;
    best_distance = distance;
  }
  if (best < kMaxUsers) return best;
  for (std::size_t t = 0; t < kMaxUsers; ++t)
    if (tracks_[t].id == 0) return t;
  for (std::size_t t = 0; t < kMaxUsers; ++t) {
    if (taken_[t] || tracks_[t].missed == 0) continue;
    if (best == kMaxUsers || tracks_[t].missed > tracks_[best].missed) best = t;
  }
  if (best < kMaxUsers) tracks_[best] = {};
  return best;
}

void UserTracker::admit(const DepthGrid& grid, const ComponentFinder& components,
                        const std::optional<FloorPlane>& floor) noexcept {
  const auto found = components.components();
  for (std::size_t c = 0; c < found.size(); ++c) {
    if (owner_of_[c] != kNobody || !in_zone(found[c], 0)) continue;
    const bool pair = pair_sized(found[c], floor);
    if (!pair && !human_sized(found[c], floor)) continue;
    const bool was_there = found[c].foreground_cells * 2 < found[c].cells;
    if (was_there && looks_like_furniture(grid, components, c, floor)) continue;
    if (pair && admit_pair(grid, components, c)) continue;
    if (!human_sized(found[c], floor)) continue;
    for (std::size_t other = 0; other < found.size() && owner_of_[c] == kNobody; ++other) {
      if (owner_of_[other] == kNobody || owner_of_[other] == kShared) continue;
      if (level_distance(found[other].centre, found[c].centre) < kSameBody) owner_of_[c] = owner_of_[other];
    }
    if (owner_of_[c] != kNobody) continue;
    const std::size_t t = place_for(found[c].centre);
    if (t == kMaxUsers) continue;
    welcome(t, found[c].centre);
    owner_of_[c] = static_cast<std::uint8_t>(t + 1);
  }
}

void UserTracker::welcome(std::size_t place, const Eigen::Vector3f& centre) noexcept {
  Track& track = tracks_[place];
  if (track.id == 0) {
    do last_id_ = static_cast<std::uint8_t>(last_id_ % kMaxId + 1);
    while (std::ranges::find(tracks_, last_id_, &Track::id) != tracks_.end());
    track = {};
    track.id = last_id_;
  }
  track.centre = centre;
  track.velocity.setZero();
  taken_[place] = true;
}

bool UserTracker::admit_pair(const DepthGrid& grid, const ComponentFinder& components, std::size_t c) noexcept {
  // Two who stand shoulder to shoulder are one component with two heads. Its outline over x has a valley.
  const Component& pair = components.components()[c];
  constexpr float kColumn = 0.04F;
  constexpr auto kColumns = static_cast<std::size_t>(kMaxPairWidth / kColumn) + 2;
  struct Column {
    float top = 1e9F;  // y of the highest point: nobody leans so far that the camera's axis will not do
    float area = 0;
    float moment = 0;
  };
  std::array<Column, kColumns> columns{};
  const auto labels = components.labels();
  const auto column_of = [&](float x) { return static_cast<std::size_t>((x - pair.left) / kColumn); };
  for (int y = 0, i = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x, ++i) {
      if (labels[at(i)] != c + 1) continue;
      const float z = grid.depth[at(i)];
      const float px = grid.ray_x[at(x)] * z;
      Column& column = columns[column_of(px)];
      column.top = std::min(column.top, grid.ray_y[at(y)] * z);
      column.area += grid.area(z);
      column.moment += grid.area(z) * px;
    }
  }
  std::size_t valley = 0;
  float deepest = kMinValley;
  Column left;
  Column all_right;
  std::array<float, 2> centre{};
  for (const Column& column : columns) {
    all_right.area += column.area;
    all_right.moment += column.moment;
  }
  for (std::size_t k = 0; k < kColumns; ++k) {
    float right_top = 1e9F;
    for (std::size_t j = k; j < kColumns; ++j) right_top = std::min(right_top, columns[j].top);
    const float right_area = all_right.area - left.area;
    const float depth = columns[k].top - std::max(left.top, right_top);
    if (left.area >= kMinOfPairArea && right_area >= kMinOfPairArea && depth > deepest) {
      const float left_x = left.moment / left.area;
      const float right_x = (all_right.moment - left.moment) / right_area;
      if (right_x - left_x >= kSameBody) {
        deepest = depth;
        valley = k;
        centre = {left_x, right_x};
      }
    }
    left.top = std::min(left.top, columns[k].top);
    left.area += columns[k].area;
    left.moment += columns[k].moment;
  }
  if (valley == 0) return false;
  std::array<std::size_t, 2> place{};
  for (std::size_t side = 0; side < 2; ++side) {
    const Eigen::Vector3f expected(centre[side], pair.centre.y(), pair.centre.z());
    place[side] = place_for(expected);
    if (place[side] == kMaxUsers) return side > 0;
    welcome(place[side], expected);
  }
  // From here on they are two who have met: as if each had been on her side a frame ago.
  owner_of_[c] = kShared;
  for (int y = 0, i = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x, ++i) {
      if (labels[at(i)] != c + 1) continue;
      const std::size_t side = column_of(grid.ray_x[at(x)] * grid.depth[at(i)]) < valley ? 0 : 1;
      previous_owners_[at(i)] = static_cast<std::uint8_t>(place[side] + 1);
      previous_depth_[at(i)] = grid.depth[at(i)];
    }
  }
  return true;
}

void UserTracker::attach(const DepthGrid& grid, const ComponentFinder& components,
                         const std::optional<FloorPlane>& floor) noexcept {
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
        const bool half = level_distance(found[c].centre, found[body].centre) < kSameBody &&
                          one_body_in_two(found[c], found[body], floor) &&
                          !looks_like_furniture(grid, components, c, floor);
        if (!half && found[c].area > most_to_attach(found[c], found[body])) continue;
        best_step = contact.smallest_step;
        owner_of_[c] = before[body];
      }
    }
  }
}

void UserTracker::share(const DepthGrid& grid, std::span<const std::uint8_t> labels) noexcept {
  // Where users have met in one component, each keeps what was hers and they grow towards each other.
  queue_.clear();
  std::ranges::fill(owners_, kNobody);
  for_each_marked(grid, labels, [&](int, int, std::size_t i) {
    std::uint8_t owner = owner_of_[labels[i] - std::size_t{1}];
    if (owner == kShared) {
      const std::uint8_t was = previous_owners_[i];
      const bool still = was != kNobody && std::abs(grid.depth[i] - previous_depth_[i]) <= kSameSurface;
      owner = still ? was : kNobody;
      if (still) queue_.push_back(static_cast<int>(i));
    }
    owners_[i] = owner;
  });
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
  std::array<int, kMaxUsers> changed{};
  sum.fill(Eigen::Vector3f::Zero());
  for_each_marked(grid, owners_, [&](int x, int y, std::size_t i) {
    const std::size_t t = owners_[i] - std::size_t{1};
    const float z = grid.depth[i];
    sum[t] += Eigen::Vector3f(grid.ray_x[at(x)] * z, grid.ray_y[at(y)] * z, z);
    area[t] += grid.area(z);
    ++cells[t];
    changed[t] += owners_at_birth_[i] != owners_[i] || std::abs(depth_at_birth_[i] - z) > continuity_tolerance(z);
  });
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
    if (track.age == 0) track.birthplace = centre;
    track.centre = centre;
    track.missed = 0;
    ++track.age;
    track.has_moved |= track.age > 1 && ((centre - track.birthplace).norm() > kMovedDistance ||
                                         static_cast<float>(changed[t]) > kMovedShare * static_cast<float>(cells[t]));
  }
  if (std::ranges::find(gone, true) == gone.end()) return;
  for (std::uint8_t& owner : owners_)
    if (owner != kNobody && gone[owner - std::size_t{1}]) owner = kNobody;
}

void UserTracker::remember_birth(const DepthGrid& grid) noexcept {
  if (std::ranges::find(tracks_, 1, &Track::age) == tracks_.end()) return;
  for_each_marked(grid, owners_, [&](int, int, std::size_t i) {
    if (tracks_[owners_[i] - std::size_t{1}].age != 1) return;
    owners_at_birth_[i] = owners_[i];
    depth_at_birth_[i] = grid.depth[i];
  });
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
