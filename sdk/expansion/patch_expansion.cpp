#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include <Eigen/Dense>
#include <armature/sdk/expansion/patch_expansion.h>
#include <armature/sdk/expansion/patch_map.h>
#include <armature/sdk/mesh/measures.h>
#include <tbb/parallel_for.h>

#include "sdk/expansion/patch_registration.h"
#include "sdk/selection/surface_walk.h"

namespace armature::sdk {
namespace {

constexpr double kApart = 0.75;     // centres of candidates, of the radius
constexpr double kSamePlace = 0.5;  // the same of candidates of different sizes
constexpr double kPromising = 0.5;  // a fit that is worth another look
constexpr double kAstray = 0.2;     // how far from its place a centre may lie without one, of the radius
constexpr double kOverlap = 0.3;    // of the smaller of two regions, beyond which they are one place

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// A place where a patch like the reference may lie.
struct Place {
  VertexId centre;
  double scale;
  float similarity;
};

/// The local maxima of a similarity map that no better one is near, best first.
std::vector<Place> maxima(const Surface& surface, const std::vector<float>& similarity, double radius, double scale,
                          std::size_t most) {
  const auto better = [&](VertexId a, VertexId b) {
    return similarity[a.index()] != similarity[b.index()] ? similarity[a.index()] > similarity[b.index()] : a < b;
  };
  std::vector<VertexId> tops;
  for (std::size_t i = 0; i < similarity.size(); ++i) {
    const VertexId vertex(i);
    if (similarity[i] > 0 && std::ranges::none_of(surface.adjacency.neighbours(vertex),
                                                  [&](VertexId other) { return better(other, vertex); }))
      tops.push_back(vertex);
  }
  std::ranges::sort(tops, better);
  std::vector<Place> places;
  for (const VertexId top : tops) {
    if (places.size() == most) break;
    const Eigen::Vector3d& p = surface.mesh.position(top);
    const bool alone = std::ranges::none_of(
        places, [&](const Place& place) { return (surface.mesh.position(place.centre) - p).norm() < kApart * radius; });
    if (alone) places.push_back({top, scale, similarity[top.index()]});
  }
  return places;
}

/// The places, best first; of those that differ in little but their size, the best two.
std::vector<std::size_t> best_of_each_place(const Surface& surface, const std::vector<Place>& places, double radius) {
  std::vector<std::size_t> order(places.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater{}, [&](std::size_t i) { return places[i].similarity; });
  std::vector<std::size_t> kept;
  for (const std::size_t i : order) {
    const auto there = std::ranges::count_if(kept, [&](std::size_t j) {
      const double size = radius * std::min(places[i].scale, places[j].scale);
      return places[i].scale != places[j].scale &&
             (surface.mesh.position(places[i].centre) - surface.mesh.position(places[j].centre)).norm() <
                 kSamePlace * size;
    });
    if (there < 2) kept.push_back(i);
  }
  return kept;
}

/// The corner that is closest to a point among those of the closest face.
VertexId vertex_under(const Surface& surface, const Eigen::Vector3d& point) {
  return closest_corner(surface.mesh, surface.tree.closest(point));
}

std::string in_words(const char* format, double a, double b = 0) {
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), format, a, b);
  return text.data();
}

std::string reason_of(double similarity, const PatchFit& laid) {
  std::string reason =
      in_words("surroundings %.0f %% alike, surfaces lie %.0f %% on one another", 100 * similarity, 100 * laid.fit);
  if (laid.mirrored) reason += ", mirrored";
  if (laid.ambiguous) reason += ", turned otherwise nearly as well";
  if (std::abs(laid.scale - 1) > 0.05) reason += in_words(", %.2g times as large", laid.scale);
  return reason;
}

/// Matches, best first, leave out what lies over the reference or a better match.
class Distinct {
 public:
  explicit Distinct(const Mesh& mesh) : areas_(face_areas(mesh)), owner_(mesh.triangles.size(), kNobody) {}

  /// Whether a region is new, which it then is no more; else the number of the region that it lies over.
  std::optional<std::size_t> taken_by(std::span<const FaceId> faces) {
    double own = 0;
    std::vector<double> shared(region_areas_.size());
    for (const FaceId face : faces) {
      own += areas_[face.index()];
      if (owner_[face.index()] != kNobody) shared[owner_[face.index()]] += areas_[face.index()];
    }
    for (std::size_t region = 0; region < shared.size(); ++region)
      if (shared[region] > kOverlap * std::min(own, region_areas_[region])) return region;
    for (const FaceId face : faces)
      if (owner_[face.index()] == kNobody) owner_[face.index()] = region_areas_.size();
    region_areas_.push_back(own);
    return std::nullopt;
  }

 private:
  static constexpr std::size_t kNobody = ~std::size_t{0};
  std::vector<double> areas_;
  std::vector<std::size_t> owner_;
  std::vector<double> region_areas_;
};

Expected<void> check(const PatchExpansionOptions& options) {
  if (options.scales.empty()) return fail("expected at least one size to look for");
  for (const double scale : options.scales)
    if (!(scale >= 1 / 8. && scale <= 8)) return fail("expected sizes from 1/8 to 8 times the patch");
  return {};
}

}  // namespace

Expected<Expansion> expand_patch(const Surface& surface, const Surface& of_patch, std::span<const FaceId> patch,
                                 const PatchExpansionOptions& options, const Task& task, PatchExpansionTimes* times) {
  if (auto checked = check(options); !checked) return tl::unexpected(checked.error());
  const auto ball = patch_ball(of_patch, patch);
  if (!ball) return tl::unexpected(ball.error());
  const bool same_surface = &surface == &of_patch;
  const std::size_t most = options.most + (same_surface ? 1 : 0);  // the reference is like itself
  PatchExpansionTimes took;

  // Where.
  auto start = Clock::now();
  const auto own = PatchContexts::build(of_patch, ball->radius, task);
  if (!own) return tl::unexpected(own.error());
  const Histogram reference = own->of(ball->centre);
  std::vector<Candidate> candidates;
  std::vector<Place> places;
  for (const double scale : options.scales) {
    std::optional<PatchContexts> made;
    if (!same_surface || scale != 1) {
      auto contexts = PatchContexts::build(surface, scale * ball->radius, task);
      if (!contexts) return tl::unexpected(contexts.error());
      made.emplace(std::move(*contexts));
    }
    const PatchContexts& contexts = made ? *made : *own;
    const auto similarity = contexts.similarity_to(reference, task);
    if (!similarity) return tl::unexpected(similarity.error());
    for (const Place& place : maxima(surface, *similarity, scale * ball->radius, scale, most)) {
      places.push_back(place);
      candidates.push_back({{}, contexts.of(place.centre)});
    }
  }
  const std::vector<std::size_t> order = best_of_each_place(surface, places, ball->radius);
  took.map_ms = milliseconds_since(start);

  // What the reference is.
  start = Clock::now();
  const FaceGraph graph_of_patch(of_patch);
  const PatchReference model(graph_of_patch, patch, *ball);
  took.learn_ms = milliseconds_since(start);

  // How it lies there, and how far it reaches.
  start = Clock::now();
  const std::clock_t processor_start = std::clock();
  std::optional<FaceGraph> graph_elsewhere;
  if (!same_surface) graph_elsewhere.emplace(surface);
  const FaceGraph& graph = same_surface ? graph_of_patch : *graph_elsewhere;
  task.report("laying the patch onto its likes", 0);
  const std::size_t looked_at = std::min(order.size(), most);
  tbb::parallel_for(std::size_t{0}, looked_at, [&](std::size_t rank) {
    if (task.stopped()) return;
    const Place& place = places[order[rank]];
    PatchFit laid = model.lay(graph, place.centre, place.scale, options.mirrored);
    // Far from where it was looked for, not all of it was in sight.
    const VertexId centre = vertex_under(surface, apply(laid.target_from_reference, model.centre()));
    const double astray = (surface.mesh.position(centre) - surface.mesh.position(place.centre)).norm();
    if (laid.fit > kPromising && astray > kAstray * place.scale * ball->radius) {
      const PatchFit again = model.lay(graph, centre, place.scale, options.mirrored);
      if (again.fit > laid.fit) laid = again;
    }
    Match& match = candidates[order[rank]].match;
    match.faces = model.extent(graph, laid);
    match.score = 0.5 * (double{place.similarity} + laid.fit);
    match.reference_from_match = laid.target_from_reference.inverse();
    match.mirrored = laid.mirrored;
    match.reason = reason_of(place.similarity, laid);
  });
  if (task.stopped()) return cancelled();
  task.report("laying the patch onto its likes", 1);
  took.matches_ms = milliseconds_since(start);
  took.matches_processor_ms = 1e3 * static_cast<double>(std::clock() - processor_start) / CLOCKS_PER_SEC;
  took.candidates = looked_at;
  if (times != nullptr) *times = took;

  // Each place once.
  std::vector<FaceId> reference_faces(patch.begin(), patch.end());
  std::ranges::sort(reference_faces);
  Distinct distinct(surface.mesh);
  if (same_surface) distinct.taken_by(reference_faces);
  std::vector<Candidate> matches;
  std::vector<Rejected> rejected;
  const auto face_at = [&](std::size_t i) {
    const auto faces = surface.adjacency.faces(places[i].centre);
    return faces.empty() ? FaceId() : faces.front();
  };
  std::vector<std::size_t> by_score(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(looked_at));
  std::ranges::stable_sort(by_score, std::greater{}, [&](std::size_t i) { return candidates[i].match.score; });
  for (const std::size_t i : by_score) {
    Match& match = candidates[i].match;
    if (match.faces.empty()) {
      rejected.push_back({face_at(i), "no face there comes to lie on the patch (" + match.reason + ")"});
    } else if (const auto other = distinct.taken_by(match.faces)) {
      const bool is_reference = same_surface && *other == 0;
      rejected.push_back({face_at(i), is_reference ? "lies over the reference itself" : "lies over a better match"});
    } else {
      matches.push_back(std::move(candidates[i]));
    }
  }
  for (const std::size_t i : std::span(order).subspan(looked_at))
    rejected.push_back({face_at(i), in_words("surroundings only %.0f %% alike: not among the best %.0f",
                                             100 * double{places[i].similarity}, static_cast<double>(looked_at))});
  return Expansion(std::move(reference_faces), std::move(matches), std::move(rejected));
}

Expected<Expansion> expand_patch(const Surface& surface, std::span<const FaceId> patch,
                                 const PatchExpansionOptions& options, const Task& task, PatchExpansionTimes* times) {
  return expand_patch(surface, surface, patch, options, task, times);
}

}  // namespace armature::sdk
