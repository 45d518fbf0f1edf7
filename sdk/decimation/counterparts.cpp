#include "sdk/decimation/counterparts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <armature/sdk/mesh/adjacency.h>
#include <armature/sdk/mesh/components.h>

#include "sdk/deformation/best_turn.h"
#include "sdk/hierarchy/collapse_complex.h"
#include "sdk/mesh/nearest_point.h"

namespace armature::sdk {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// How much areas and spreads of components may differ that are held against one another.
constexpr double kAlike = 0.05;
// So many vertices are looked at to tell whether a component lies on another; so many of them must be within an edge.
constexpr std::size_t kSamples = 256;
constexpr double kOnIt = 0.95;
// And so many to lay it there.
constexpr std::size_t kFitted = 1024;
// A component is symmetric if so many of its vertices correspond to others: one that is only nearly so is better left
// alone.
constexpr double kMatched = 0.9;
// What corresponds lies so much closer than anything else.
constexpr double kClear = 0.5;

/// What hangs together.
struct Part {
  std::vector<std::uint32_t> vertices = {};
  double area = 0;
  Vector3d middle = Vector3d::Zero();  // of the area
  Matrix3d axes = Matrix3d::Identity();
  Vector3d spread = Vector3d::Zero();  // of the area along the axes, ascending
  double edge = 0;                     // mean length
};

std::vector<Part> parts_of(const Mesh& mesh) {
  const Components components = find_components(mesh, Adjacency(mesh), LinkedBy::Vertices);
  std::vector<Part> parts(components.count);
  std::vector<Matrix3d> second(parts.size(), Matrix3d::Zero());
  std::vector<std::size_t> sides(parts.size(), 0);
  std::vector<std::uint8_t> seen(mesh.positions.size(), 0);
  // About a point of the part, so that digits are kept wherever it lies.
  const auto from = [&](std::uint32_t part) { return mesh.positions[parts[part].vertices.front()]; };
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const std::uint32_t k = components.of_face[f];
    if (k == Components::kNone) continue;
    Part& part = parts[k];
    for (const VertexId corner : mesh.triangles[f])
      if (std::exchange(seen[corner.index()], std::uint8_t{1}) == 0)
        part.vertices.push_back(static_cast<std::uint32_t>(corner.index()));
    std::array<Vector3d, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = mesh.corner(FaceId(f), i) - from(k);
    const double area = 0.5 * (p[1] - p[0]).cross(p[2] - p[0]).norm();
    const Vector3d sum = p[0] + p[1] + p[2];
    part.area += area;
    part.middle += area / 3 * sum;
    second[k] += area / 12 * sum * sum.transpose();
    for (std::size_t i = 0; i < 3; ++i) {
      second[k] += area / 12 * p[i] * p[i].transpose();
      part.edge += (p[(i + 1) % 3] - p[i]).norm();
    }
    sides[k] += 3;
  }
  for (std::uint32_t k = 0; k < parts.size(); ++k) {
    Part& part = parts[k];
    if (!(part.area > 0) || !second[k].allFinite()) continue;
    part.middle /= part.area;
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(
        Matrix3d(second[k] / part.area - part.middle * part.middle.transpose()));
    part.axes = solver.eigenvectors();
    part.spread = solver.eigenvalues();
    part.middle += from(k);
    part.edge /= static_cast<double>(sides[k]);
  }
  return parts;
}

bool may_be_alike(const Part& a, const Part& b) {
  return std::abs(a.area - b.area) <= kAlike * a.area && (a.spread - b.spread).norm() <= kAlike * a.spread.norm();
}

/// Takes a part to where it lies on another, or on itself.
struct Motion {
  Matrix3d turn;  // or mirror
  Vector3d from, to;

  [[nodiscard]] Vector3d operator()(const Vector3d& point) const { return to + turn * (point - from); }
  [[nodiscard]] Motion back() const { return {turn.transpose(), to, from}; }
};

/// Turns and mirrors of the axes of one part into those of another; the first of a part into itself is none.
std::vector<Motion> motions_between(const Part& from, const Part& to) {
  std::vector<Motion> motions = {{Matrix3d::Identity(), from.middle, to.middle}};
  for (unsigned signs = 0; signs < 8; ++signs) {
    const Vector3d s((signs & 1U) != 0 ? -1 : 1, (signs & 2U) != 0 ? -1 : 1, (signs & 4U) != 0 ? -1 : 1);
    if (&from != &to || signs != 0)
      motions.push_back({to.axes * s.asDiagonal() * from.axes.transpose(), from.middle, to.middle});
  }
  return motions;
}

/// A part and a tree of its vertices, by their places in it.
struct Searched {
  const Part* part;
  NearestPoint tree;

  Searched(const Mesh& mesh, const Part& of) : part(&of), tree(points(mesh, of)) {}

  static std::vector<Vector3d> points(const Mesh& mesh, const Part& part) {
    std::vector<Vector3d> list;
    for (const auto v : part.vertices) list.push_back(mesh.positions[v]);
    return list;
  }
};

/// How far some vertices of a part lie from another's, as a mean in edges; infinite if it does not lie on it.
double distance(const Mesh& mesh, const Part& from, const Searched& to, const Motion& motion) {
  const std::size_t step = (from.vertices.size() + kSamples - 1) / kSamples;
  const double edge2 = to.part->edge * to.part->edge;
  std::size_t looked_at = 0;
  std::size_t off = 0;
  double sum = 0;
  const auto most_off =
      static_cast<std::size_t>((1 - kOnIt) * static_cast<double>((from.vertices.size() + step - 1) / step));
  for (std::size_t i = 0; i < from.vertices.size(); i += step, ++looked_at) {
    const auto found = to.tree.find(motion(mesh.positions[from.vertices[i]]), edge2);
    off += found.point == kNoIndex ? 1U : 0U;
    if (off > most_off) return std::numeric_limits<double>::infinity();
    sum += std::sqrt(found.distance2 / edge2);
  }
  return sum / static_cast<double>(looked_at);
}

/// The motion nearby that lays a part on another: iterated closest points (Besl and McKay 1992), which noise and other
/// triangles mislead less than they do principal axes.
Motion refined(const Mesh& mesh, const Part& from, const Searched& to, Motion motion) {
  constexpr int kRounds = 8;
  const std::size_t step = (from.vertices.size() + kFitted - 1) / kFitted;
  const double edge2 = to.part->edge * to.part->edge;
  const double mirrored = motion.turn.determinant() < 0 ? -1 : 1;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<std::pair<Vector3d, Vector3d>> pairs;
    Motion next{.turn = Matrix3d::Zero(), .from = Vector3d::Zero(), .to = Vector3d::Zero()};
    for (std::size_t i = 0; i < from.vertices.size(); i += step) {
      const Vector3d& here = mesh.positions[from.vertices[i]];
      const auto found = to.tree.find(motion(here), edge2);
      if (found.point == kNoIndex) continue;
      pairs.emplace_back(here, mesh.positions[to.part->vertices[found.point]]);
      next.from += pairs.back().first;
      next.to += pairs.back().second;
    }
    next.from /= static_cast<double>(pairs.size());
    next.to /= static_cast<double>(pairs.size());
    for (const auto& [here, there] : pairs)
      next.turn += (there - next.to) * (mirrored * (here - next.from)).transpose();
    // A point mirror, then a turn.
    next.turn = mirrored * best_turn(next.turn);
    motion = next;
  }
  return motion;
}

/// The vertex of a part that is clearly the closest to a place; kNoIndex for none.
std::uint32_t clearly_closest(const Searched& part, const Vector3d& place) {
  const auto found = part.tree.find(place, part.part->edge * part.part->edge);
  if (found.point == kNoIndex) return kNoIndex;
  const auto next = part.tree.find(place, found.distance2 / (kClear * kClear), found.point);
  return next.point == kNoIndex ? found.point : kNoIndex;
}

/// By the place of each vertex of `from`, that of the one of `to` that it corresponds to; kNoIndex for none.
std::vector<std::uint32_t> matches(const Mesh& mesh, const Searched& from, const Searched& to, const Motion& motion) {
  std::vector<std::uint32_t> list;
  const Motion back = motion.back();
  for (std::uint32_t i = 0; i < from.part->vertices.size(); ++i) {
    const auto j = clearly_closest(to, motion(mesh.positions[from.part->vertices[i]]));
    const bool mutual = j != kNoIndex && clearly_closest(from, back(mesh.positions[to.part->vertices[j]])) == i;
    list.push_back(mutual ? j : kNoIndex);
  }
  return list;
}

}  // namespace

Expected<Correspondence> find_correspondence(const Mesh& mesh, const Task& task) {
  const std::vector<Part> parts = parts_of(mesh);
  Correspondence result;
  auto& classes = result.classes;
  classes.resize(mesh.positions.size(), kNoIndex);
  result.copies.resize(mesh.positions.size(), kNoIndex);
  std::uint32_t models = 0;
  const auto add_copy = [&](const Part& part) {
    for (const auto v : part.vertices) result.copies[v] = static_cast<std::uint32_t>(result.models.size());
    result.models.push_back(models);
  };
  std::vector<std::uint8_t> done(parts.size(), 0);
  std::uint32_t count = 0;
  std::vector<std::uint32_t> own_counterparts;  // classes of what lies on a plane of symmetry
  for (std::size_t k = 0; k < parts.size(); ++k) {
    if (task.stopped()) return cancelled();
    task.report("finding counterparts", static_cast<double>(k) / static_cast<double>(parts.size()));
    const Part& first = parts[k];
    if (std::exchange(done[k], std::uint8_t{1}) != 0 || !(first.area > 0)) continue;
    const Searched searched(mesh, first);
    // A class for each vertex and what it corresponds to within the part.
    std::vector<std::uint32_t> own(first.vertices.size(), kNoIndex);
    std::vector<std::vector<std::uint32_t>> onto_itself;
    for (const Motion& motion : motions_between(first, first))
      if (!motion.turn.isIdentity() && std::isfinite(distance(mesh, first, searched, motion))) {
        auto match = matches(mesh, searched, searched, motion);
        const auto none = static_cast<double>(std::ranges::count(match, kNoIndex));
        if (none <= (1 - kMatched) * static_cast<double>(match.size())) onto_itself.push_back(std::move(match));
      }
    bool any = !onto_itself.empty();
    bool copied = false;
    for (std::uint32_t i = 0; i < own.size(); ++i) {
      if (own[i] != kNoIndex) continue;
      own[i] = count++;
      for (const auto& match : onto_itself)
        if (match[i] == i) {
          own_counterparts.push_back(own[i]);
        } else if (match[i] != kNoIndex && own[match[i]] == kNoIndex) {
          own[match[i]] = own[i];
        }
    }
    for (std::size_t other = k + 1; other < parts.size(); ++other) {
      if (done[other] != 0 || !may_be_alike(first, parts[other])) continue;
      if (task.stopped()) return cancelled();
      const Searched there(mesh, parts[other]);
      double least = std::numeric_limits<double>::infinity();
      Motion best{};
      for (const Motion& motion : motions_between(first, parts[other])) {
        const double d = distance(mesh, first, there, motion);
        if (d < least) {
          least = d;
          best = motion;
        }
      }
      if (!std::isfinite(least)) continue;
      best = refined(mesh, first, there, best);
      any = true;
      done[other] = 1;
      if (std::exchange(copied, true) == false) add_copy(first);
      add_copy(parts[other]);
      const auto match = matches(mesh, searched, there, best);
      for (std::size_t i = 0; i < match.size(); ++i)
        if (match[i] != kNoIndex) classes[parts[other].vertices[match[i]]] = own[i];
    }
    if (copied) ++models;
    if (!any) continue;
    for (std::size_t i = 0; i < own.size(); ++i) classes[first.vertices[i]] = own[i];
  }
  // What is alone in its class has no counterpart, unless it is its own.
  std::vector<std::uint32_t> members(count, 0);
  for (const auto c : classes)
    if (c != kNoIndex) ++members[c];
  for (const auto c : own_counterparts) members[c] = std::max(members[c], 2U);
  for (auto& c : classes)
    if (c != kNoIndex && members[c] < 2) c = kNoIndex;
  return result;
}

Counterparts::Counterparts(const Correspondence& correspondence)
    : copy_(correspondence.copies), model_(correspondence.models), left_(model_.size(), 0) {
  const auto& classes = correspondence.classes;
  if (std::ranges::all_of(classes, [](std::uint32_t c) { return c == kNoIndex; })) return;
  kinds_.resize(classes.size(), 0);
  list_.resize(classes.size(), 0);
  place_.resize(classes.size(), 0);
  into_.resize(classes.size());
  std::iota(into_.begin(), into_.end(), 0U);
  holds_.resize(classes.size(), kNoIndex);
  next_ = into_;
  for (const auto copy : copy_)
    if (copy != kNoIndex) ++left_[copy];
  for (std::uint32_t copy = 0; copy < model_.size(); ++copy) {
    copies_.resize(std::max<std::size_t>(copies_.size(), model_[copy] + 1));
    copies_[model_[copy]].push_back(copy);
  }
  joined_.resize(copies_.size(), false);
  least_.resize(copies_.size());
  for (std::uint32_t copy = 0; copy < model_.size(); ++copy) count(copy);
  std::unordered_map<std::uint32_t, std::uint32_t> of_class;
  for (std::uint32_t v = 0; v < classes.size(); ++v) {
    if (classes[v] == kNoIndex) continue;
    // SplitMix64 (Steele, Lea, Flood 2014).
    std::uint64_t z = (classes[v] + std::uint64_t{1}) * 0x9E37'79B9'7F4A'7C15U;
    z = (z ^ (z >> 30)) * 0xBF58'476D'1CE4'E5B9U;
    z = (z ^ (z >> 27)) * 0x94D0'49BB'1331'11EBU;
    kinds_[v] = z ^ (z >> 31);
    add(v);
    holds_[v] = v;
    const auto [first, is_new] = of_class.try_emplace(classes[v], v);
    if (!is_new) std::swap(next_[v], next_[first->second]);
  }
}

std::uint32_t Counterparts::holder(std::uint32_t slot) noexcept {
  while (into_[slot] != slot) slot = into_[slot] = into_[into_[slot]];
  return slot;
}

void Counterparts::add(std::uint32_t slot) {
  const auto [found, is_new] = lists_of_.try_emplace(kinds_[slot], kNoIndex);
  if (is_new) {
    if (free_lists_.empty()) {
      free_lists_.push_back(static_cast<std::uint32_t>(lists_.size()));
      lists_.emplace_back();
    }
    found->second = free_lists_.back();
    free_lists_.pop_back();
  }
  list_[slot] = found->second;
  auto& slots = lists_[list_[slot]];
  place_[slot] = static_cast<std::uint32_t>(slots.size());
  slots.push_back(slot);
}

void Counterparts::remove(std::uint32_t slot) {
  if (kinds_[slot] == 0) return;
  auto& slots = lists_[list_[slot]];
  slots[place_[slot]] = slots.back();
  place_[slots.back()] = place_[slot];
  slots.pop_back();
  if (!slots.empty()) return;
  free_lists_.push_back(list_[slot]);
  lists_of_.erase(kinds_[slot]);
}

void Counterparts::count(std::uint32_t copy) {
  Left& least = least_[model_[copy]];
  if (left_[copy] < least.slots) least = {.slots = left_[copy]};
  if (left_[copy] == least.slots) ++least.copies;
}

void Counterparts::merge(std::uint32_t kept, std::uint32_t gone) {
  if (kinds_.empty()) return;
  into_[gone] = kept;
  if (copy_[gone] == copy_[kept]) {
    if (copy_[kept] != kNoIndex) {
      --left_[copy_[kept]];
      count(copy_[kept]);
    }
  } else if (copy_[kept] == kNoIndex) {
    copy_[kept] = copy_[gone];
  } else if (copy_[gone] != kNoIndex) {
    joined_[model_[copy_[gone]]] = joined_[model_[copy_[kept]]] = true;
  }
  if (kinds_[gone] == 0) return;
  remove(kept);
  remove(gone);
  kinds_[kept] += std::exchange(kinds_[gone], 0);
  if (kinds_[kept] != 0) add(kept);
  if (holds_[kept] == kNoIndex) holds_[kept] = holds_[gone];
}

std::span<const std::uint32_t> Counterparts::behind(std::uint32_t slot, std::size_t& walks) {
  behind_.clear();
  if (kinds_.empty() || kinds_[slot] == 0) return behind_;
  for (auto v = next_[holds_[slot]]; v != holds_[slot] && walks > 0; v = next_[v], --walks)
    if (const auto other = holder(v); kinds_[other] != kinds_[slot]) behind_.push_back(other);
  return behind_;
}

}  // namespace armature::sdk
