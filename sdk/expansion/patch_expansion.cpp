#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include <Eigen/Dense>
#include <armature/sdk/expansion/patch_expansion.h>
#include <armature/sdk/expansion/patch_map.h>
#include <armature/sdk/mesh/measures.h>
#include <tbb/parallel_for.h>

#include "sdk/expansion/patch_places.h"
#include "sdk/expansion/patch_registration.h"
#include "sdk/expansion/spread_context.h"
#include "sdk/selection/surface_walk.h"

namespace armature::sdk {
namespace {

constexpr double kPromising = 0.5;  // a fit that is worth another look
constexpr double kAstray = 0.2;     // how far from its place a centre may lie without one, of the radius
constexpr double kOverlap = 0.3;    // of the smaller of two regions, beyond which they are one place

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
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
  if (laid.turns_as_well || laid.mirrors_as_well) {
    reason += ", nearly as well";
    if (laid.turns_as_well) reason += " turned otherwise";
    if (laid.turns_as_well && laid.mirrors_as_well) reason += " or";
    if (laid.mirrors_as_well) reason += laid.mirrored ? " not mirrored" : " mirrored";
  }
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
    std::map<std::size_t, double> shared;  // with regions, in order
    for (const FaceId face : faces) {
      own += areas_[face.index()];
      if (owner_[face.index()] != kNobody) shared[owner_[face.index()]] += areas_[face.index()];
    }
    for (const auto& [region, area] : shared)
      if (area > kOverlap * std::min(own, region_areas_[region])) return region;
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
  const std::size_t asked_for = std::min(options.most, surface.mesh.positions.size());
  const std::size_t most = asked_for + (same_surface ? 1 : 0);  // the reference is like itself
  PatchExpansionTimes took;

  // Where.
  auto start = Clock::now();
  const auto own = PatchContexts::build(of_patch, ball->radius, task);
  if (!own) return tl::unexpected(own.error());
  const Histogram reference = own->of(ball->centre);
  std::vector<Candidate> candidates;
  std::vector<PatchPlace> places;  // of the candidates
  std::vector<PatchPlace> passed_over;
  for (const double scale : options.scales) {
    const std::size_t before = places.size();
    std::optional<PatchContexts> made;
    if (!same_surface || scale != 1) {
      auto contexts = PatchContexts::build(surface, scale * ball->radius, task);
      if (!contexts) return tl::unexpected(contexts.error());
      made.emplace(std::move(*contexts));
    }
    const PatchContexts& contexts = made ? *made : *own;
    const auto similarity = contexts.similarity_to(reference, task);
    if (!similarity) return tl::unexpected(similarity.error());
    for (const PatchPlace& place : maxima(surface, *similarity, scale * ball->radius, scale)) {
      if (places.size() == before + most) {
        passed_over.push_back(place);
        continue;
      }
      if (task.stopped()) return cancelled();
      const PatchContext context = spread(contexts.of(place.centre));
      places.push_back(place);
      candidates.push_back({{}, {context.begin(), context.end()}});
    }
  }
  const RankedPlaces by_context = ranked(surface, places, ball->radius);
  const std::vector<std::size_t>& order = by_context.first;
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
    const PatchPlace& place = places[order[rank]];
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
  const auto face_at = [&](const PatchPlace& place) {
    const auto faces = surface.adjacency.faces(place.centre);
    return faces.empty() ? FaceId() : faces.front();
  };
  std::vector<std::size_t> by_score(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(looked_at));
  std::ranges::stable_sort(by_score, std::greater{}, [&](std::size_t i) { return candidates[i].match.score; });
  for (const std::size_t i : by_score) {
    if (task.stopped()) return cancelled();
    Match& match = candidates[i].match;
    if (match.faces.empty()) {
      rejected.push_back({face_at(places[i]), "no face there comes to lie on the patch (" + match.reason + ")"});
    } else if (const auto other = distinct.taken_by(match.faces)) {
      const bool is_reference = same_surface && *other == 0;
      rejected.push_back(
          {face_at(places[i]), is_reference ? "lies over the reference itself" : "lies over a better match"});
    } else {
      matches.push_back(std::move(candidates[i]));
    }
  }
  for (const std::size_t i : by_context.others)
    rejected.push_back({face_at(places[i]), "surroundings more alike at two other sizes"});
  const auto reject_unseen = [&](const PatchPlace& place) {
    rejected.push_back({face_at(place), in_words("surroundings only %.0f %% alike: not among the best %.0f",
                                                 100 * double{place.similarity}, static_cast<double>(asked_for))});
  };
  for (const std::size_t i : std::span(order).subspan(looked_at)) reject_unseen(places[i]);
  std::ranges::for_each(passed_over, reject_unseen);
  return Expansion(std::move(reference_faces), std::move(matches), std::move(rejected));
}

Expected<Expansion> expand_patch(const Surface& surface, std::span<const FaceId> patch,
                                 const PatchExpansionOptions& options, const Task& task, PatchExpansionTimes* times) {
  return expand_patch(surface, surface, patch, options, task, times);
}

}  // namespace armature::sdk
