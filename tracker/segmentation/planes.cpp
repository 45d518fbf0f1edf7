#include "tracker/segmentation/planes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace armature {
namespace {

constexpr int kSampleStep = 2;  ///< cells between samples
constexpr float kTolerance = 2.5F * kDisparityStep;

constexpr int kFloorTrials = 160;
constexpr int kFloorTrialsWanted = 60;  ///< hypotheses that look like a floor, after which it is enough
constexpr int kSearchPeriod = 16;       ///< frames between searches once a floor is known
constexpr int kFollowPeriod = 4;        ///< frames between measurements of a settled floor
constexpr int kSettledFrames = 20;      ///< measurements over which a floor is averaged
constexpr int kEagerFrames = 10;        ///< first frames, in which every one is searched

// Where a sensor may stand above a floor, and how it may be tilted and rolled.
constexpr float kMinHeight = 0.4F;
constexpr float kMaxHeight = 2.6F;
constexpr float kMaxTiltSine = 0.52F;
constexpr float kMaxRollSine = 0.20F;
// What must be seen of it.
constexpr float kMinFloorArea = 0.75F;   ///< square metres of ground, in squares of kGroundSquare
constexpr float kGroundSquare = 0.25F;   ///< metres
constexpr float kMinFloorExtent = 0.5F;  ///< metres, the shorter of along and across
constexpr float kMinFloorSlope = 0.2F;   ///< 1/m: how inverse depth changes with ray_y; 1 / (camera height) when level
constexpr float kMaxFloorSlope = 3.0F;
constexpr float kMaxShareBelow = 0.03F;  ///< of all samples: a table top has a room below it
constexpr float kBelow = 0.12F;          ///< metres under the plane that count as below
constexpr int kForgetFloorMeasurements = 75;

constexpr int kWallTrials = 48;
constexpr float kMinWallArea = 1.5F;    ///< square metres seen: more than anybody's front
constexpr float kMaxWallSlope = 0.35F;  ///< sine of a wall's lean

float height_above(const FloorPlane& plane, float ray_x, float ray_y, float z) noexcept {
  return z * (plane.normal.x() * ray_x + plane.normal.y() * ray_y + plane.normal.z()) + plane.offset;
}

bool could_be_floor(const ImagePlane& plane) noexcept {
  if (plane.b <= 0) return false;
  const FloorPlane p = in_space(plane);
  return p.offset >= kMinHeight && p.offset <= kMaxHeight && std::abs(p.normal.z()) <= kMaxTiltSine &&
         std::abs(p.normal.x()) <= kMaxRollSine;
}

/// Whether the column of `rows` cells above (negative) or below a cell is smooth and inclined as a floor is.
bool slopes_like_floor(const DepthGrid& grid, int x, int y, int rows) noexcept {
  const int end = y + rows;
  if (end < 0 || end >= grid.height) return false;
  const auto w = [&](int row) { return grid.inverse_depth[static_cast<std::size_t>(row * grid.width + x)]; };
  if (w(end) <= 0 || w(y + rows / 2) <= 0) return false;
  const auto ray_y = [&](int row) { return grid.ray_y[static_cast<std::size_t>(row)]; };
  const float slope = (w(end) - w(y)) / (ray_y(end) - ray_y(y));
  const float middle = w(y) + slope * (ray_y(y + rows / 2) - ray_y(y));
  return slope > kMinFloorSlope && slope < kMaxFloorSlope && std::abs(middle - w(y + rows / 2)) < 1.5F * kDisparityStep;
}

}  // namespace

FloorPlane in_space(const ImagePlane& plane) noexcept {
  const Eigen::Vector3f abc(plane.a, plane.b, plane.c);
  const float norm = std::max(abc.norm(), 1e-6F);
  return {-abc / norm, 1.0F / norm};
}

PlaneFinder::PlaneFinder(int max_cells) {
  const auto n = static_cast<std::size_t>(max_cells);
  samples_.reserve(n);
  floor_like_.reserve(n);
  remaining_.reserve(n);
}

void PlaneFinder::update(const DepthGrid& grid, std::span<const std::uint8_t> users) noexcept {
  random_state_ = 0x9E3779B9U;
  const bool search = frame_ < kEagerFrames || frame_ % kSearchPeriod == 0;
  const bool follow = floor_ && (floor_age_ < kSettledFrames || frame_ % kFollowPeriod == 0);
  if (search || follow || !floor_) collect(grid, users);
  if (follow) follow_floor();
  if (search || !floor_) find_floor();
  if (search) find_walls();
  if (frame_ < 1 << 30) ++frame_;
}

void PlaneFinder::collect(const DepthGrid& grid, std::span<const std::uint8_t> users) noexcept {
  samples_.clear();
  floor_like_.clear();
  const int reach = std::max(1, grid.height / 24);
  for (int y = kSampleStep / 2; y < grid.height; y += kSampleStep) {
    for (int x = kSampleStep / 2; x < grid.width; x += kSampleStep) {
      const auto cell = static_cast<std::size_t>(y * grid.width + x);
      const float w = grid.inverse_depth[cell];
      if (w <= 0 || users[cell] != 0) continue;
      Sample s{grid.ray_x[static_cast<std::size_t>(x)], grid.ray_y[static_cast<std::size_t>(y)], w,
               grid.area(grid.depth[cell]) * kSampleStep * kSampleStep, false};
      s.floor_like = slopes_like_floor(grid, x, y, -reach) || slopes_like_floor(grid, x, y, reach);
      if (s.floor_like) floor_like_.push_back(static_cast<std::uint16_t>(samples_.size()));
      samples_.push_back(s);
    }
  }
}

std::uint32_t PlaneFinder::random(std::uint32_t below) noexcept {
  random_state_ ^= random_state_ << 13;
  random_state_ ^= random_state_ >> 17;
  random_state_ ^= random_state_ << 5;
  return random_state_ % below;
}

std::optional<ImagePlane> PlaneFinder::through_random_samples(std::span<const std::uint16_t> from) noexcept {
  Eigen::Matrix3f rays;
  Eigen::Vector3f w;
  for (int i = 0; i < 3; ++i) {
    const Sample& s = samples_[from[random(static_cast<std::uint32_t>(from.size()))]];
    rays.row(i) << s.ray_x, s.ray_y, 1.0F;
    w[i] = s.inverse_depth;
  }
  const float determinant = rays.determinant();
  if (std::abs(determinant) < 1e-3F) return std::nullopt;
  const Eigen::Vector3f abc = rays.inverse() * w;
  return ImagePlane{abc[0], abc[1], abc[2]};
}

std::optional<ImagePlane> PlaneFinder::refined(ImagePlane plane, std::span<const std::uint16_t> from,
                                               float tolerance) const noexcept {
  for (int round = 0; round < 2; ++round) {
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    int n = 0;
    for (const std::uint16_t i : from) {
      const Sample& s = samples_[i];
      if (std::abs(plane.inverse_depth(s.ray_x, s.ray_y) - s.inverse_depth) > tolerance) continue;
      const Eigen::Vector3d r(s.ray_x, s.ray_y, 1.0);
      A += r * r.transpose();
      b += r * static_cast<double>(s.inverse_depth);
      ++n;
    }
    if (n < 12) return std::nullopt;
    const Eigen::Vector3d abc = A.ldlt().solve(b);
    if (!abc.allFinite()) return std::nullopt;
    plane = {static_cast<float>(abc[0]), static_cast<float>(abc[1]), static_cast<float>(abc[2])};
  }
  return plane;
}

PlaneFinder::Support PlaneFinder::floor_support(const ImagePlane& plane) const noexcept {
  const FloorPlane p = in_space(plane);
  Support support;
  // Every fourth sample is enough to compare hypotheses.
  for (std::size_t i = 0; i < samples_.size(); i += 4) {
    const Sample& s = samples_[i];
    const float difference = s.inverse_depth - plane.inverse_depth(s.ray_x, s.ray_y);
    if (std::abs(difference) < kTolerance) {
      if (s.floor_like) support.inliers += 1;
    } else if (difference < 0 && height_above(p, s.ray_x, s.ray_y, 1.0F / s.inverse_depth) < -kBelow) {
      support.below += 1;
    }
  }
  return support;
}

bool PlaneFinder::is_floor(const ImagePlane& plane) const noexcept {
  if (!could_be_floor(plane)) return false;
  const FloorPlane p = in_space(plane);
  // Occupied squares of the ground: a floor is an area, a row of feet is not.
  constexpr int kSide = 48;
  std::array<std::uint8_t, kSide * kSide> squares{};
  int below = 0;
  for (const Sample& s : samples_) {
    const float z = 1.0F / s.inverse_depth;
    const float height = height_above(p, s.ray_x, s.ray_y, z);
    if (height < -kBelow && s.inverse_depth < plane.inverse_depth(s.ray_x, s.ray_y) - kTolerance) ++below;
    if (!s.floor_like || std::abs(plane.inverse_depth(s.ray_x, s.ray_y) - s.inverse_depth) > kTolerance) continue;
    const int column = static_cast<int>(s.ray_x * z / kGroundSquare + kSide / 2);
    const int row = static_cast<int>(z / kGroundSquare);
    if (column < 0 || column >= kSide || row >= kSide) continue;
    squares[static_cast<std::size_t>(row * kSide + column)] = 1;
  }
  if (static_cast<float>(below) > kMaxShareBelow * static_cast<float>(samples_.size())) return false;
  int occupied = 0;
  int left = kSide, right = -1, near = kSide, far = -1;
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) {
      if (squares[static_cast<std::size_t>(row * kSide + column)] == 0) continue;
      ++occupied;
      left = std::min(left, column);
      right = std::max(right, column);
      near = std::min(near, row);
      far = std::max(far, row);
    }
  }
  const float extent = kGroundSquare * static_cast<float>(std::min(right - left, far - near) + 1);
  return static_cast<float>(occupied) * kGroundSquare * kGroundSquare >= kMinFloorArea && extent >= kMinFloorExtent;
}

void PlaneFinder::find_floor() noexcept {
  if (floor_like_.size() < 24) return;
  std::optional<ImagePlane> best;
  float best_score = 0;
  int wanted = kFloorTrialsWanted;
  for (int trial = 0; trial < kFloorTrials && wanted > 0; ++trial) {
    const auto plane = through_random_samples(floor_like_);
    if (!plane || !could_be_floor(*plane)) continue;
    --wanted;
    const Support support = floor_support(*plane);
    const float score = support.inliers - 3 * support.below;
    if (score <= best_score) continue;
    best_score = score;
    best = plane;
  }
  if (!best) return;
  best = refined(*best, floor_like_, kTolerance);
  if (!best || !is_floor(*best)) return;
  if (floor_) {
    const Support now = floor_support(*floor_);
    if (now.inliers - 3 * now.below > 0.7F * best_score) return;
  }
  floor_ = best;
  floor_age_ = 1;
  floor_unseen_ = 0;
}

void PlaneFinder::follow_floor() noexcept {
  const auto seen = refined(*floor_, floor_like_, kTolerance);
  if (!seen || !is_floor(*seen)) {
    if (++floor_unseen_ > kForgetFloorMeasurements) floor_.reset();
    return;
  }
  floor_unseen_ = 0;
  floor_age_ = std::min(floor_age_ + 1, kSettledFrames);
  const float t = 1.0F / static_cast<float>(floor_age_);
  floor_->a += t * (seen->a - floor_->a);
  floor_->b += t * (seen->b - floor_->b);
  floor_->c += t * (seen->c - floor_->c);
}

void PlaneFinder::find_walls() noexcept {
  wall_count_ = 0;
  const Eigen::Vector3f up = floor_ ? in_space(*floor_).normal : Eigen::Vector3f(-Eigen::Vector3f::UnitY());
  const float max_slope = floor_ ? kMaxWallSlope : kMaxWallSlope + 0.3F;
  const auto explained = [](const Sample& s, const ImagePlane& plane) {
    return std::abs(plane.inverse_depth(s.ray_x, s.ray_y) - s.inverse_depth) < kTolerance;
  };
  remaining_.clear();
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    if (floor_ && explained(samples_[i], *floor_)) continue;
    remaining_.push_back(static_cast<std::uint16_t>(i));
  }
  while (wall_count_ < kMaxWalls && remaining_.size() > 100) {
    std::optional<ImagePlane> best;
    float best_area = 0;
    const std::size_t step = 1 + remaining_.size() / 600;
    for (int trial = 0; trial < kWallTrials; ++trial) {
      const auto plane = through_random_samples(remaining_);
      if (!plane || std::abs(in_space(*plane).normal.dot(up)) > max_slope) continue;
      float area = 0;
      for (std::size_t i = 0; i < remaining_.size(); i += step) {
        const Sample& s = samples_[remaining_[i]];
        if (explained(s, *plane)) area += s.area;
      }
      if (area <= best_area) continue;
      best_area = area;
      best = plane;
    }
    if (!best) return;
    best = refined(*best, remaining_, kTolerance);
    if (!best) return;
    float area = 0;
    for (const std::uint16_t i : remaining_)
      if (explained(samples_[i], *best)) area += samples_[i].area;
    if (area < kMinWallArea) return;
    walls_[wall_count_++] = *best;
    std::erase_if(remaining_, [&](std::uint16_t i) { return explained(samples_[i], *best); });
  }
}

}  // namespace armature
