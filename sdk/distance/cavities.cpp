#include "sdk/distance/cavities.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <tbb/parallel_for.h>

namespace armature::sdk {

using Eigen::Vector3d;

namespace {

/// What must be free around the middle of a cell, and of the way to the next, in cells: no leaving through cracks.
constexpr double kClearance = 0.4;

}  // namespace

Cavities::Cavities(const SphereMeshTree& tree, int resolution, const Task& task) {
  const auto [lower, upper] = tree.bounds();
  const double longest = (upper - lower).maxCoeff();
  if (!(longest > 0)) return;
  spacing_ = longest / resolution;
  // A layer of cells around the box, so that what is outside hangs together.
  origin_ = lower.array() - spacing_;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    count_[axis] = static_cast<int>(std::ceil((upper[a] - lower[a]) / spacing_)) + 2;
  }
  cells_.assign(
      static_cast<std::size_t>(count_[0]) * static_cast<std::size_t>(count_[1]) * static_cast<std::size_t>(count_[2]),
      Cell::Free);
  free_around_.assign(cells_.size(), static_cast<float>(spacing_ / 2));
  int size = 1;
  while (size < std::max({count_[0], count_[1], count_[2]})) size *= 2;
  task.report("finding voids", 0);
  classify(tree, {0, 0, 0}, size, task);
  flood(tree, task);
  free_around_ = {};
  any_ = std::find(cells_.begin(), cells_.end(), Cell::Free) != cells_.end();
}

Vector3d Cavities::middle(const std::array<int, 3>& cell) const noexcept {
  return origin_ + spacing_ * Vector3d(cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5);
}

void Cavities::classify(const SphereMeshTree& tree, const std::array<int, 3>& first, int size, const Task& task) {
  if (task.stopped()) return;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (first[axis] >= count_[axis]) return;
  const Vector3d centre =
      origin_ + spacing_ * Vector3d(first[0] + size / 2.0, first[1] + size / 2.0, first[2] + size / 2.0);
  const double reach = std::sqrt(3.0) / 2 * (size - 1) * spacing_;  // to the middle of the farthest cell
  const double distance = tree.signed_distance(centre);
  if (size == 1 && distance > kClearance * spacing_) {
    free_around_[index(first)] = static_cast<float>(distance);
    return;
  }
  if (distance > reach + spacing_ / 2) return;  // free, half a cell around each middle, as all are at first
  if (size == 1 || distance <= -reach) {
    for (int z = first[2]; z < std::min(first[2] + size, count_[2]); ++z)
      for (int y = first[1]; y < std::min(first[1] + size, count_[1]); ++y)
        for (int x = first[0]; x < std::min(first[0] + size, count_[0]); ++x) cells_[index({x, y, z})] = Cell::Solid;
    return;
  }
  const int half = size / 2;
  const auto part = [&](int k) {
    classify(tree, {first[0] + (k & 1) * half, first[1] + (k >> 1 & 1) * half, first[2] + (k >> 2) * half}, half, task);
  };
  constexpr int kWorthAThread = 32;
  if (half >= kWorthAThread) {
    tbb::parallel_for(0, 8, part);
  } else {
    for (int k = 0; k < 8; ++k) part(k);
  }
}

bool Cavities::joined(const SphereMeshTree& tree, const std::array<int, 3>& a, const std::array<int, 3>& b) const {
  const double at_a = free_around_[index(a)];
  const double at_b = free_around_[index(b)];
  if (at_a + at_b >= spacing_ * (1 - 1e-6)) return true;
  // Balls around points between must cover the rest of the way.
  const std::function<bool(const Vector3d&, double, const Vector3d&, double)> open =
      [&](const Vector3d& from, double free_from, const Vector3d& to, double free_to) {
        const double length = (to - from).norm();
        if (free_from + free_to >= length) return true;
        if (length < 1e-2 * spacing_) return false;
        const Vector3d between = (from + to) / 2;
        const double free_between = tree.signed_distance(between);
        return free_between > kClearance * spacing_ && open(from, free_from, between, free_between) &&
               open(between, free_between, to, free_to);
      };
  return open(middle(a), at_a, middle(b), at_b);
}

void Cavities::flood(const SphereMeshTree& tree, const Task& task) {
  // By rows along x: each stretch of free cells is filled at once, and its neighbours looked through for others.
  struct Stretch {
    int first, end, y, z;
  };
  std::vector<Stretch> front;
  const auto is_free = [&](int x, int y, int z) { return cells_[index({x, y, z})] == Cell::Free; };
  const auto fill = [&](int x, int y, int z) {
    Stretch s{x, x + 1, y, z};
    while (s.first > 0 && is_free(s.first - 1, y, z) && joined(tree, {s.first, y, z}, {s.first - 1, y, z})) --s.first;
    while (s.end < count_[0] && is_free(s.end, y, z) && joined(tree, {s.end - 1, y, z}, {s.end, y, z})) ++s.end;
    const auto begin = cells_.begin() + static_cast<std::ptrdiff_t>(index({s.first, y, z}));
    std::fill(begin, begin + (s.end - s.first), Cell::Outer);
    front.push_back(s);
  };
  fill(0, 0, 0);
  while (!front.empty() && !task.stopped()) {
    const Stretch s = front.back();
    front.pop_back();
    for (const auto& [dy, dz] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
      const int y = s.y + dy;
      const int z = s.z + dz;
      if (y < 0 || y >= count_[1] || z < 0 || z >= count_[2]) continue;
      for (int x = s.first; x < s.end; ++x)
        if (is_free(x, y, z) && joined(tree, {x, s.y, s.z}, {x, y, z})) fill(x, y, z);
    }
  }
}

Cavities::Space Cavities::look(const SphereMeshTree& tree, const Vector3d& x, NearestSphere& nearest) const noexcept {
  const Vector3d place = (x - origin_) / spacing_;
  std::array<int, 3> cell{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double along = place[static_cast<Eigen::Index>(axis)];
    if (!(along >= 0 && along < count_[axis])) return Space::Open;
    cell[axis] = static_cast<int>(along);
  }
  nearest = tree.nearest(x);
  if (nearest.distance <= (x - middle(cell)).norm()) return Space::Narrow;
  const Cell state = cells_[index(cell)];
  if (state == Cell::Solid) return Space::Narrow;
  return state == Cell::Free ? Space::Closed : Space::Open;
}

Cavities::Space Cavities::space_at(const SphereMeshTree& tree, const Vector3d& point) const {
  constexpr int kMostSteps = 40;
  constexpr double kMomentum = 0.7;  // between two walls their normals alternate; their sum leads out
  Vector3d x = point;
  Vector3d away = Vector3d::Zero();
  NearestSphere nearest;
  for (int step = 0; step < kMostSteps; ++step) {
    if (const Space found = look(tree, x, nearest); found != Space::Narrow) return found;
    if (nearest.distance < 0) break;
    away = kMomentum * away + nearest.normal;
    x += std::max(0.7 * nearest.distance, 1e-6 * spacing_) * away.normalized();
  }
  return explore(tree, point);
}

Cavities::Space Cavities::explore(const SphereMeshTree& tree, const Vector3d& point) const {
  struct Ball {
    Vector3d centre;
    double radius;
    bool spent;
  };
  constexpr std::size_t kMostBalls = 200;
  std::vector<Ball> balls;
  NearestSphere nearest;
  if (const Space found = look(tree, point, nearest); found != Space::Narrow) return found;
  balls.push_back({point, std::max(nearest.distance, 1e-3 * spacing_), false});
  while (balls.size() < kMostBalls) {
    // The widest first: it leads out the fastest.
    std::size_t widest = balls.size();
    for (std::size_t k = 0; k < balls.size(); ++k)
      if (!balls[k].spent && (widest == balls.size() || balls[k].radius > balls[widest].radius)) widest = k;
    if (widest == balls.size()) return Space::Narrow;
    balls[widest].spent = true;
    const Ball from = balls[widest];
    for (int k = 0; k < 27; ++k) {
      const Vector3d direction(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
      if (k == 13) continue;
      const Vector3d x = from.centre + 0.95 * from.radius * direction.normalized();
      const bool known = std::any_of(balls.begin(), balls.end(), [&](const Ball& b) {
        return (x - b.centre).squaredNorm() < 0.49 * b.radius * b.radius;
      });
      if (known) continue;
      if (const Space found = look(tree, x, nearest); found != Space::Narrow) return found;
      if (nearest.distance > 0.05 * from.radius && nearest.distance > 1e-4 * spacing_)
        balls.push_back({x, nearest.distance, false});
    }
  }
  return Space::Narrow;
}

bool Cavities::faces(const SphereMeshTree& tree, const Vector3d& point, const Vector3d& normal) const {
  // Thin walls are not passed through; what the point lies off the surface by is none, however flat the way.
  const auto sees = [&](const Vector3d& from) {
    const double way = (point - from).norm();
    const auto hit = tree.intersect({from, (point - from) / way});
    return !hit || hit->t > way - 0.02 * way - 0.01 * spacing_;
  };
  // As far off as nothing else is much nearer; beside another wall, between the two.
  double step = spacing_;
  for (int k = 0; k < 12; ++k, step /= 2) {
    const Vector3d ahead = point + step * normal;
    const NearestSphere nearest = tree.nearest(ahead);
    if (nearest.distance >= 0.3 * step && sees(ahead)) return holds(tree, ahead);
    const Vector3d between = normal + nearest.normal;
    if (!(between.squaredNorm() > 1e-6)) continue;
    const Vector3d off = point + step * between.normalized();
    if (tree.signed_distance(off) >= 0.03 * step && sees(off)) return holds(tree, off);
  }
  return holds(tree, point + step * normal);
}

}  // namespace armature::sdk
