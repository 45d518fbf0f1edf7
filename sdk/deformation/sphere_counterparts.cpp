#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include <Eigen/Eigenvalues>
#include <armature/sdk/deformation/deform.h>
#include <armature/sdk/deformation/sphere_counterparts.h>
#include <armature/sdk/distance/mesh_tree.h>

#include "sdk/deformation/best_turn.h"

namespace armature::sdk {
namespace {

using Eigen::Affine3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// The surface about a region is looked at up to so many of its spreads, and counts as a Gaussian of so many.
constexpr double kReach = 3, kSigma = 1.5;
// So many vertices at most are looked at; so many to tell at a glance.
constexpr std::size_t kSamples = 256, kGlance = 32;
// What fits so many times worse than is allowed at a glance is not looked at again; the best few others are.
constexpr double kGlanceMisfit = 4;
constexpr std::size_t kRefined = 4;
constexpr int kRounds = 8;
// Spreads of what corresponds differ by so many times at most; radii and places by so many spreads.
constexpr double kSize = 1.3, kPlace = 0.5;
// Turns that fit so nearly alike, in spreads, are told apart by the whole mesh.
constexpr double kEqually = 0.02;

/// Where some vertices lie.
struct Extent {
  Vector3d middle = Vector3d::Zero();
  double spread = 0;  // their root mean square distance from it
};

/// The surface about them.
struct Place : Extent {
  std::vector<Vector3d> points = {};  // of the surface about them
  std::vector<double> weights = {};
  std::array<Matrix3d, 2> axes = {};  // principal, of the surface within one and two reaches
};

/// So many at most, evenly taken.
std::vector<Vector3d> thinned(const std::vector<Vector3d>& all, std::size_t most) {
  std::vector<Vector3d> some;
  const std::size_t step = (all.size() + most - 1) / most;
  for (std::size_t k = 0; k < all.size(); k += step) some.push_back(all[k]);
  return some;
}

Matrix3d principal_axes(std::span<const Vector3d> points) {
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& p : points) mean += p / static_cast<double>(points.size());
  Matrix3d second = Matrix3d::Zero();
  for (const Vector3d& p : points) second += (p - mean) * (p - mean).transpose();
  return Eigen::SelfAdjointEigenSolver<Matrix3d>(second).eigenvectors();
}

Extent extent_of(const Mesh& mesh, std::span<const VertexId> vertices) {
  Extent extent;
  const auto count = static_cast<double>(vertices.size());
  for (const VertexId v : vertices) extent.middle += mesh.position(v) / count;
  for (const VertexId v : vertices) extent.spread += (mesh.position(v) - extent.middle).squaredNorm() / count;
  extent.spread = std::sqrt(extent.spread);
  return extent;
}

Place place_of(const Mesh& mesh, const Extent& extent) {
  Place place{extent};
  std::array<std::vector<Vector3d>, 2> near;
  for (const Vector3d& p : mesh.positions) {
    const double distance = (p - place.middle).norm();
    if (distance <= kReach * place.spread) near[0].push_back(p);
    if (distance <= 2 * kReach * place.spread) near[1].push_back(p);
  }
  for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) place.axes[k] = principal_axes(near[k]);
  place.points = thinned(near[0], kSamples);
  for (const Vector3d& p : place.points)
    place.weights.push_back(std::exp(-(p - place.middle).squaredNorm() / (2 * std::pow(kSigma * place.spread, 2))));
  return place;
}

/// Lays surface on surface.
class Fitting {
 public:
  explicit Fitting(const Mesh& mesh)
      : tree_(mesh), all_(thinned(mesh.positions, kSamples)), axes_(principal_axes(mesh.positions)) {}

  /// How far points of a place, so many at most, lie from the surface: a weighted mean in spreads.
  [[nodiscard]] double misfit(const Place& place, const Affine3d& motion, std::size_t most) const {
    const std::size_t step = (place.points.size() + most - 1) / most;
    double sum = 0;
    double weight = 0;
    for (std::size_t k = 0; k < place.points.size(); k += step) {
      sum += place.weights[k] * off(motion * place.points[k], place.spread);
      weight += place.weights[k];
    }
    return sum / (weight * place.spread);
  }
  /// The same to and fro.
  [[nodiscard]] double misfit(const Place& from, const Place& to, const Affine3d& motion) const {
    return (misfit(from, motion, kSamples) + misfit(to, motion.inverse(), kSamples)) / 2;
  }
  /// How far the whole mesh lies from itself, not more than a length each.
  [[nodiscard]] double whole(const Affine3d& motion, double length) const {
    double sum = 0;
    for (const Vector3d& p : all_) sum += off(motion * p, length);
    return sum;
  }
  /// Motions that may lay one place on another, roughly.
  [[nodiscard]] std::vector<Affine3d> motions(const Place& from, const Place& to) const {
    std::vector<Matrix3d> turns;
    for (unsigned signs = 0; signs < 8; ++signs) {
      const Vector3d s((signs & 1U) != 0 ? -1 : 1, (signs & 2U) != 0 ? -1 : 1, (signs & 4U) != 0 ? -1 : 1);
      turns.emplace_back(axes_ * s.asDiagonal() * axes_.transpose());
      for (const std::size_t k : {std::size_t{0}, std::size_t{1}})
        turns.emplace_back(to.axes[k] * s.asDiagonal() * from.axes[k].transpose());
    }
    // The mirror between the two.
    const Vector3d d = (to.middle - from.middle).normalized();
    turns.emplace_back(Matrix3d::Identity() - 2 * d * d.transpose());
    std::vector<Affine3d> motions;
    for (const Matrix3d& turn : turns)
      motions.push_back(Eigen::Translation3d(to.middle) * Affine3d(turn) * Eigen::Translation3d(-from.middle));
    return motions;
  }
  /// The motion nearby that lays a place on the surface (iterated closest points: Besl and McKay 1992).
  [[nodiscard]] Affine3d refined(const Place& place, Affine3d motion) const {
    const double mirrored = motion.linear().determinant() < 0 ? -1 : 1;
    for (int round = 0; round < kRounds; ++round) {
      std::vector<Vector3d> there;
      Vector3d from = Vector3d::Zero();
      Vector3d to = Vector3d::Zero();
      double weight = 0;
      for (std::size_t k = 0; k < place.points.size(); ++k) {
        there.push_back(tree_.closest(motion * place.points[k]).point);
        from += place.weights[k] * place.points[k];
        to += place.weights[k] * there.back();
        weight += place.weights[k];
      }
      from /= weight;
      to /= weight;
      Matrix3d S = Matrix3d::Zero();
      for (std::size_t k = 0; k < there.size(); ++k)
        S += place.weights[k] * (there[k] - to) * (mirrored * (place.points[k] - from)).transpose();
      // A point mirror, then a turn.
      motion = Eigen::Translation3d(to) * Affine3d(Matrix3d(mirrored * best_turn(S))) * Eigen::Translation3d(-from);
    }
    return motion;
  }

 private:
  [[nodiscard]] double off(const Vector3d& point, double most) const {
    return std::min(most, tree_.closest(point, {.within = most}).distance);
  }

  MeshTree tree_;
  std::vector<Vector3d> all_;
  Matrix3d axes_;
};

bool alike(double a, double b) {
  return a <= kSize * b && b <= kSize * a;
}

/// Where spheres of a level come to lie by a motion, if there are others of their size: as many, none of them theirs.
std::vector<SphereId> spheres_there(const std::vector<Sphere>& level, std::span<const SphereId> reference,
                                    const Affine3d& motion, double within) {
  std::vector<SphereId> found;
  for (const SphereId from : reference) {
    const Sphere& sphere = level[from.index()];
    const Vector3d place = motion * sphere.centre;
    double least = within;
    SphereId best;
    for (std::size_t s = 0; s < level.size(); ++s) {
      const double distance = (level[s].centre - place).norm();
      if (distance >= least || std::abs(level[s].radius - sphere.radius) > within) continue;
      least = distance;
      best = SphereId(s);
    }
    if (!best.valid() || std::ranges::find(found, best) != found.end() ||
        std::ranges::find(reference, best) != reference.end())
      return {};
    found.push_back(best);
  }
  return found;
}

Expected<void> checked(const Mesh& mesh, const Hierarchy& hierarchy, std::size_t spheres,
                       std::span<const SphereId> reference, const CounterpartOptions& options) {
  if (auto same = check_same(mesh, hierarchy); !same) return same;
  if (spheres < hierarchy.min_spheres() || spheres > hierarchy.leaf_count())
    return fail("level: expected " + std::to_string(hierarchy.min_spheres()) + " to " +
                std::to_string(hierarchy.leaf_count()) + " spheres, found " + std::to_string(spheres));
  if (reference.empty()) return fail("reference: expected spheres, found none");
  if (!(options.most_misfit > 0) || !std::isfinite(options.most_misfit))
    return fail("most misfit: expected a positive number");
  return check(SphereMove{.spheres = {reference.begin(), reference.end()}}, spheres);
}

/// The spheres of a level and the surface about each, which is looked for when it is first asked for.
class Places {
 public:
  Places(const Mesh& mesh, const Hierarchy& hierarchy, std::size_t spheres) : mesh_(mesh), places_(spheres) {
    for (const NodeId node : hierarchy.nodes_of_level(spheres))
      extents_.push_back(extent_of(mesh, hierarchy.vertices(node)));
  }

  [[nodiscard]] const Extent& extent(SphereId s) const { return extents_[s.index()]; }
  const Place& operator[](SphereId s) {
    auto& place = places_[s.index()];
    if (!place) place = place_of(mesh_, extents_[s.index()]);
    return *place;
  }

 private:
  const Mesh& mesh_;
  std::vector<Extent> extents_;
  std::vector<std::optional<Place>> places_;
};

/// How far the surface about spheres lies from that about others: of the worst of them.
double worst_misfit(const Fitting& fitting, Places& places, std::span<const SphereId> from,
                    std::span<const SphereId> to, const Affine3d& motion) {
  double worst = 0;
  for (std::size_t k = 0; k < from.size(); ++k) {
    if (!alike(places.extent(from[k]).spread, places.extent(to[k]).spread))
      return std::numeric_limits<double>::infinity();
    if (places.extent(from[k]).spread > 0)
      worst = std::max(worst, fitting.misfit(places[from[k]], places[to[k]], motion));
  }
  return worst;
}

}  // namespace

Expected<std::vector<SphereCounterpart>> sphere_counterparts(const Mesh& mesh, const Hierarchy& hierarchy,
                                                             std::size_t spheres, std::span<const SphereId> given,
                                                             const CounterpartOptions& options, const Task& task) {
  if (auto fine = checked(mesh, hierarchy, spheres, given, options); !fine) return tl::unexpected(fine.error());
  if (mesh.triangles.empty()) return std::vector<SphereCounterpart>{};
  std::vector<SphereId> reference;
  for (const SphereId s : given)
    if (std::ranges::find(reference, s) == reference.end()) reference.push_back(s);
  const auto level = hierarchy.level(spheres);
  if (!level) return tl::unexpected(level.error());
  const auto nodes = hierarchy.nodes_of_level(spheres);
  const Fitting fitting(mesh);
  std::vector<VertexId> vertices;
  for (const SphereId s : reference) {
    const auto more = hierarchy.vertices(nodes[s.index()]);
    vertices.insert(vertices.end(), more.begin(), more.end());
  }
  // All of the reference is laid down, at first so that its largest sphere comes to lie on another.
  const Place whole = place_of(mesh, extent_of(mesh, vertices));
  const SphereId seed =
      *std::ranges::max_element(reference, {}, [&](SphereId s) { return hierarchy.vertices(nodes[s.index()]).size(); });
  Places places(mesh, hierarchy, spheres);
  const Extent from = places.extent(seed);
  if (!(from.spread > 0)) return std::vector<SphereCounterpart>{};

  std::vector<SphereCounterpart> found;
  for (std::size_t s = 0; s < spheres; ++s) {
    if (task.stopped()) return cancelled();
    task.report("finding counterparts", static_cast<double>(s) / static_cast<double>(spheres));
    const SphereId seed_there(s);
    if (std::ranges::find(reference, seed_there) != reference.end()) continue;
    if (!alike(from.spread, places.extent(seed_there).spread)) continue;
    std::vector<std::pair<double, Affine3d>> rough;
    for (const Affine3d& motion : fitting.motions(places[seed], places[seed_there])) {
      const double misfit = fitting.misfit(whole, motion, kGlance);
      if (misfit < kGlanceMisfit * options.most_misfit) rough.emplace_back(misfit, motion);
    }
    std::ranges::stable_sort(rough, {}, &std::pair<double, Affine3d>::first);
    if (rough.size() > kRefined) rough.resize(kRefined);
    std::optional<SphereCounterpart> best;
    double best_of_whole = std::numeric_limits<double>::infinity();
    for (const auto& [misfit, motion] : rough) {
      const Affine3d fine = fitting.refined(whole, motion);
      auto there = spheres_there(level->spheres, reference, fine, kPlace * from.spread);
      if (there.empty()) continue;
      const double here = worst_misfit(fitting, places, reference, there, fine);
      const double all = fitting.whole(fine, whole.spread);
      if (!(here < options.most_misfit)) continue;
      if (best && (std::abs(here - best->misfit) < kEqually ? all >= best_of_whole : here > best->misfit)) continue;
      best = {.spheres = std::move(there), .from_reference = fine, .misfit = here};
      best_of_whole = all;
    }
    if (best) found.push_back(std::move(*best));
  }
  std::ranges::stable_sort(found, {}, &SphereCounterpart::misfit);
  std::vector<SphereCounterpart> each;
  for (SphereCounterpart& one : found)
    if (std::ranges::none_of(
            each, [&](const auto& other) { return std::ranges::is_permutation(other.spheres, one.spheres); }))
      each.push_back(std::move(one));
  return each;
}

SphereMove carried(const SphereMove& move, const SphereCounterpart& counterpart) {
  const Matrix3d& turn = counterpart.from_reference.linear();
  SphereMove result = move;
  result.spheres = counterpart.spheres;
  result.translate = turn * move.translate;
  result.rotate = turn.determinant() * (turn * move.rotate);  // an axis is mirrored with its sense
  if (move.about) result.about = counterpart.from_reference * *move.about;
  return result;
}

SphereMove share_of(const SphereMove& move, double share) {
  SphereMove result = move;
  result.translate *= share;
  result.rotate *= share;
  result.scale = std::pow(move.scale, share);
  return result;
}

Expected<std::vector<SphereMove>> with_counterparts(const Mesh& mesh, const Hierarchy& hierarchy, std::size_t spheres,
                                                    std::span<const SphereMove> moves, const SwingOptions& options,
                                                    const Task& task) {
  if (!std::isfinite(options.time)) return fail("time: expected a finite number");
  for (std::size_t k = 0; k < options.phases.size(); ++k)
    if (!std::isfinite(options.phases[k])) return fail("phases[" + std::to_string(k) + "]: expected a finite number");
  const auto at = [&](double time) { return std::sin(2 * std::numbers::pi * time); };
  std::vector<SphereMove> all;
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const std::string place = "move " + std::to_string(i) + ": ";
    if (auto fine = check(moves[i], spheres); !fine) return fail(place + fine.error().message);
    all.push_back(share_of(moves[i], at(options.time)));
    if (moves[i].spheres.empty()) continue;
    const auto counterparts =
        sphere_counterparts(mesh, hierarchy, spheres, moves[i].spheres, options.counterparts, task);
    if (!counterparts && counterparts.error().kind == ErrorKind::Cancelled) return tl::unexpected(counterparts.error());
    if (!counterparts) return fail(place + counterparts.error().message);
    std::vector<std::uint8_t> moved(spheres, 0);
    std::size_t followers = 0;
    for (const SphereCounterpart& counterpart : *counterparts) {
      if (std::ranges::any_of(counterpart.spheres, [&](SphereId s) { return moved[s.index()] != 0; })) continue;
      for (const SphereId s : counterpart.spheres) moved[s.index()] = 1;
      const double phase = options.phases.empty() ? 0 : options.phases[followers % options.phases.size()];
      all.push_back(share_of(carried(moves[i], counterpart), at(options.time - phase)));
      ++followers;
    }
  }
  return all;
}

}  // namespace armature::sdk
