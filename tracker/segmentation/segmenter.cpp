#include "tracker/segmentation/segmenter.h"

#include <algorithm>
#include <array>
#include <vector>

#include "tracker/segmentation/background_model.h"
#include "tracker/segmentation/components.h"
#include "tracker/segmentation/depth_grid.h"
#include "tracker/segmentation/human_shape.h"
#include "tracker/segmentation/planes.h"
#include "tracker/segmentation/stored_background.h"
#include "tracker/segmentation/user_mask.h"
#include "tracker/segmentation/user_tracker.h"

namespace armature {
namespace {

/// All that depends on the size of the image.
struct Stages {
  Stages(const Intrinsics& intrinsics, const SegmentationOptions& options)
      : grid(make_depth_grid(intrinsics)),
        planes(grid.size()),
        background(grid.size()),
        components(grid.size()),
        on_walls(grid.size()),
        tracker(options, grid.size()),
        kind(static_cast<std::size_t>(grid.size())),
        wall(static_cast<std::size_t>(grid.size())),
        cover(static_cast<std::size_t>(grid.size())),
        mask(static_cast<std::size_t>(intrinsics.width) * static_cast<std::size_t>(intrinsics.height)) {}

  DepthGrid grid;
  PlaneFinder planes;
  BackgroundModel background;
  ComponentFinder components;
  ComponentFinder on_walls;  ///< what lies on the plane of a wall
  UserTracker tracker;
  std::vector<std::uint8_t> kind;  ///< as ComponentFinder::find() takes it
  std::vector<std::uint8_t> wall;  ///< not 0 = on the plane of a wall
  std::vector<BackgroundModel::Cover> cover;
  std::vector<std::uint8_t> mask;
  std::array<User, UserTracker::kMaxUsers> users{};
};

constexpr float kWallThickness = 2.5F * kDisparityStep;

}  // namespace

struct Segmenter::State {
  SegmentationOptions options;
  Intrinsics intrinsics;
  std::optional<Stages> stages;
  Segmentation result;

  [[nodiscard]] std::optional<FloorShadow> floor_shadow() const noexcept {
    return stages->planes.floor() ? std::optional<FloorShadow>(*stages->planes.floor()) : std::nullopt;
  }
  void find_candidates() noexcept;
  void look_before_walls() noexcept;
  void publish(DepthView frame) noexcept;
};

Segmenter::Segmenter(const SegmentationOptions& options) : state_(std::make_unique<State>()) {
  state_->options = options;
}
Segmenter::~Segmenter() = default;
Segmenter::Segmenter(Segmenter&&) noexcept = default;
Segmenter& Segmenter::operator=(Segmenter&&) noexcept = default;

void Segmenter::reset(const Intrinsics& intrinsics) {
  state_->result = {};
  state_->intrinsics = intrinsics;
  state_->stages.reset();
  if (!usable(intrinsics)) return;
  Stages& stages = state_->stages.emplace(intrinsics, state_->options);
  const auto& empty = state_->options.background;
  if (empty == nullptr || !empty->fits(intrinsics)) return;
  sample({.depth_mm = empty->depth_mm, .intrinsics = intrinsics, .sequence = 0, .sensor = {}, .host = {}}, stages.grid);
  stages.background.adopt(stages.grid.inverse_depth);
}

const Segmentation& Segmenter::process(DepthView frame) noexcept {
  State& state = *state_;
  if (!(frame.intrinsics == state.intrinsics)) reset(frame.intrinsics);
  if (!state.stages || frame.depth_mm.size() != state.stages->mask.size()) {
    state.result = {};
    return state.result;
  }
  Stages& stages = *state.stages;
  sample(frame, stages.grid);
  stages.planes.update(stages.grid, stages.tracker.owners());
  state.result.floor.reset();
  state.result.up = -Eigen::Vector3f::UnitY();
  if (stages.planes.floor()) {
    state.result.floor = in_space(*stages.planes.floor());
    state.result.up = state.result.floor->normal;
  }
  state.find_candidates();
  stages.components.find(stages.grid, stages.kind, state.result.up);
  stages.tracker.update(stages.grid, stages.components, state.result.floor);
  using Cover = BackgroundModel::Cover;
  std::ranges::fill(stages.cover, Cover::Nobody);
  const auto mark = [&](Cover cover) {
    return [&stages, cover](int, int, std::size_t cell) { stages.cover[cell] = cover; };
  };
  for_each_marked(stages.grid, stages.tracker.owners(), mark(Cover::User));
  for_each_marked(stages.grid, stages.tracker.dismissed(), mark(Cover::Furniture));
  stages.background.learn(stages.grid, stages.cover);
  state.publish(frame);
  return state.result;
}

void Segmenter::State::find_candidates() noexcept {
  const DepthGrid& grid = stages->grid;
  const std::optional<FloorShadow> shadow = floor_shadow();
  const std::span<const float> depth = grid.depth;
  const std::span<const float> inverse_depth = grid.inverse_depth;
  const std::span<std::uint8_t> kind = stages->kind;
  const BackgroundModel& background = stages->background;
  const std::span<std::uint8_t> wall = stages->wall;
  constexpr int kBlock = BackgroundModel::kBlock;
  bool walls_seen = false;
  std::ranges::fill(kind, std::uint8_t{0});
  std::ranges::fill(wall, std::uint8_t{0});
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      const std::size_t i =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(grid.width) + static_cast<std::size_t>(x);
      if (x % kBlock == 0 && x + kBlock <= grid.width && background.nothing_new(i, inverse_depth)) {
        x += kBlock - 1;
        continue;
      }
      const float z = depth[i];
      if (z <= 0 || z < options.near_m || z > options.far_m) continue;
      const float w = inverse_depth[i];
      const auto cell = background.classify(i, w);
      if (cell == BackgroundModel::Cell::Background) continue;
      const float ray_x = grid.ray_x[static_cast<std::size_t>(x)];
      const float ray_y = grid.ray_y[static_cast<std::size_t>(y)];
      if (shadow && shadow->covers(ray_x, ray_y, w)) continue;
      const bool on_wall = std::ranges::any_of(stages->planes.walls(), [&](const ImagePlane& plane) {
        return std::abs(plane.inverse_depth(ray_x, ray_y) - w) < kWallThickness;
      });
      if (on_wall && cell == BackgroundModel::Cell::Unknown && !stages->tracker.still_user(i, z)) {
        wall[i] = 1;
        walls_seen = true;
        continue;
      }
      kind[i] = cell == BackgroundModel::Cell::Foreground ? 2 : 1;
    }
  }
  if (walls_seen) look_before_walls();
}

void Segmenter::State::look_before_walls() noexcept {
  // A plane through two things may pass through somebody between them. She is a piece of it for herself, and not flat.
  stages->on_walls.find(stages->grid, stages->wall, result.up);
  const auto pieces = stages->on_walls.components();
  for (std::size_t c = 0; c < pieces.size(); ++c) {
    if (!human_sized(pieces[c], result.floor) || looks_flat(stages->grid, stages->on_walls, c)) continue;
    for_each_marked(stages->grid, stages->on_walls.labels(), [&](int, int, std::size_t cell) {
      if (stages->on_walls.labels()[cell] == c + 1) stages->kind[cell] = 1;
    });
  }
}

void Segmenter::State::publish(DepthView frame) noexcept {
  std::array<std::uint8_t, UserTracker::kMaxUsers> ids{};
  stages->users = {};
  const auto tracks = stages->tracker.tracks();
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    ids[t] = tracks[t].id;
    stages->users[t].id = tracks[t].id;
    stages->users[t].centre = tracks[t].centre;
  }
  const std::optional<FloorShadow> shadow = floor_shadow();
  draw_user_mask(frame, {stages->grid, stages->tracker.owners(), ids, shadow ? &*shadow : nullptr}, stages->mask,
                 stages->users);
  std::ranges::sort(stages->users, [](const User& a, const User& b) {
    return a.pixel_count != b.pixel_count ? a.pixel_count > b.pixel_count : a.id < b.id;
  });
  const auto seen = std::ranges::count_if(stages->users, [](const User& user) { return user.pixel_count > 0; });
  result.user_of_pixel = stages->mask;
  result.users = std::span<const User>(stages->users).first(static_cast<std::size_t>(seen));
}

}  // namespace armature
