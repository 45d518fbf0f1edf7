#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <armature/sdk/hierarchy/build.h>
#include <armature/sdk/mesh/curvature.h>

#include "sdk/hierarchy/build_with.h"
#include "sdk/hierarchy/collapse_complex.h"
#include "sdk/hierarchy/decimation.h"
#include "sdk/hierarchy/links.h"
#include "sdk/hierarchy/recorder.h"
#include "sdk/hierarchy/sqem_metric.h"
#include "sdk/hierarchy/staves.h"
#include "sdk/mesh/point_surface.h"

namespace armature::sdk {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// What is wrong with the options, or nothing.
std::string fault(const Fitted& shape, const HierarchyOptions& options) {
  const Mesh& mesh = shape.mesh;
  const auto count = [](std::size_t n) { return std::to_string(n); };
  if (!(options.importance >= 0) || !std::isfinite(options.importance)) return "importance: expected 0 or more";
  if (!(options.regularise >= 0) || !std::isfinite(options.regularise)) return "regularise: expected 0 or more";
  if (const double c = options.compactness.value_or(0); !(c >= 0) || !std::isfinite(c))
    return "compactness: expected 0 or more";
  if (!(options.radius_per_width >= 0) || !std::isfinite(options.radius_per_width))
    return "radius per width: expected 0 or more";
  if (!(options.enrichment >= 0) || !std::isfinite(options.enrichment)) return "enrichment: expected 0 or more";
  if (options.enrichment > 0 && options.keep_topology) return "enrichment: expected 0 where the topology is kept";
  if (shape.points != nullptr && options.weights.empty() && options.importance > 0)
    return "importance: expected 0 for points, which have no faces to tell their curvature by, or weights";
  if (shape.points != nullptr && options.keep_topology) return "keep topology: points have none to keep; leave it out";
  if (!options.weights.empty() && options.weights.size() != mesh.positions.size())
    return "weights: expected one a vertex, " + count(mesh.positions.size()) + ", found " +
           count(options.weights.size());
  for (std::size_t v = 0; v < options.weights.size(); ++v)
    if (!(options.weights[v] > 0) || !std::isfinite(options.weights[v]))
      return "weights, vertex " + count(v) + ": expected a positive number";
  if (!options.labels.empty() && options.labels.size() != mesh.positions.size())
    return "labels: expected one a vertex, " + count(mesh.positions.size()) + ", found " + count(options.labels.size());
  std::vector<bool> seen(options.pinned.empty() ? 0 : mesh.positions.size(), false);
  for (std::size_t k = 0; k < options.pinned.size(); ++k) {
    const auto& [vertex, sphere] = options.pinned[k];
    const std::string at = "pinned, sphere " + count(k) + ": ";
    if (!vertex.valid() || vertex.index() >= seen.size())
      return at + "expected the number of a vertex below " + count(seen.size());
    if (seen[vertex.index()]) return at + "vertex " + count(vertex.index()) + " is pinned already";
    seen[vertex.index()] = true;
    if (sphere && !(sphere->centre.allFinite() && std::isfinite(sphere->radius) && sphere->radius >= 0))
      return at + "expected a finite centre and a finite radius that is not negative";
  }
  return {};
}

/// All that decimation works with; gone before the hierarchy is put together, which takes less.
class Builder {
 public:
  Builder(const Fitted& shape, const HierarchyOptions& options, std::span<const double> weights,
          SimilarCollapses* similar)
      : options_(options),
        shape_(NormalisedShape::of(shape.mesh, options.own_frame ? ShapeFrame::Own : ShapeFrame::Model, shape.points)),
        metric_(shape_, {.weights = weights,
                         .regularise = options.regularise,
                         .compactness = options.compactness.value_or(0),
                         .by_increase = options.by_increase,
                         .radius_per_width = options.radius_per_width}),
        complex_(vertex_count(), shape_.triangles, links_of_loose_vertices(shape_, options.labels)),
        recorder_(shape_.positions.size()),
        decimation_(metric_, complex_,
                    {.keep_topology = options.keep_topology,
                     .penalise_flips = options.penalise_flips,
                     .labels = options.labels},
                    similar),
        wanted_(vertex_count() -
                static_cast<std::uint32_t>(std::clamp<std::size_t>(options.stop_at, 1, vertex_count()))) {
    for (const auto& [vertex, sphere] : options.pinned) {
      const auto slot = static_cast<std::uint32_t>(vertex.index());
      const Sphere pinned = sphere ? Sphere{shape_.from_model(sphere->centre), sphere->radius / shape_.scale}
                                   : Sphere{shape_.positions[slot], 0};
      metric_.pin(slot, pinned);
      recorder_.pin(slot, pinned);
    }
    if (!options.keep_topology) add_links(links_through_the_solid(shape_, options.enrichment));
    shape_.positions = {};
    shape_.triangles = {};
    shape_.normals = {};
    shape_.areas = {};
    decimation_.offer(0);
  }

  /// False if the task was stopped, which is told how far that has come as `stage`.
  bool decimate(std::string_view stage, const Task& task) {
    if (!collapse(wanted_, stage, task)) return false;
    collapses_ = complex_.steps();
    recorder_.take_steps(decimation_.steps());
    return true;
  }

  /// Whether what was decimated cuts long straight parts along, into staves. Decimates further, if need be, but keeps
  /// nothing of it. Nothing if the task was stopped.
  std::optional<bool> cuts_along(const Mesh& mesh, const Task& task) {
    constexpr std::uint32_t kSpheres = 20;        // a long tube's first ones follow one another
    constexpr std::uint32_t kLeastVertices = 10;  // for each of them
    constexpr double kMost = 0.1;                 // of the area
    const auto vertices = static_cast<std::uint32_t>(mesh.positions.size());
    const std::uint32_t coarsest = vertices / kLeastVertices;
    if (coarsest < kSpheres || options_.stop_at > coarsest || options_.pinned.size() > kSpheres) return false;
    const std::uint32_t coarse = vertices - kSpheres;
    if (!collapse(coarse, "looking for staves", task)) return std::nullopt;
    return complex_.steps() >= coarse && share_of_staves(mesh, recorder_.regions(coarse)) > kMost;
  }

  [[nodiscard]] std::uint32_t collapses() const noexcept { return collapses_; }
  [[nodiscard]] Recorder take_recorder() {
    recorder_.take(complex_);
    recorder_.keep(collapses_);
    return std::move(recorder_);
  }
  /// How it lies in the model; its parts are gone.
  [[nodiscard]] NormalisedShape take_shape() noexcept { return std::move(shape_); }

 private:
  /// Until so many collapses are done, or none is left; false if the task was stopped.
  bool collapse(std::uint32_t wanted, std::string_view stage, const Task& caller) {
    const std::uint32_t first = complex_.steps();
    const Task task{.stop = caller.stop, .progress = [&](std::string_view, double) {
                      caller.report(stage, static_cast<double>(complex_.steps() - first) / (wanted - first));
                    }};
    const auto record = [&](std::uint32_t kept, std::uint32_t gone) {
      recorder_.record(kept, gone, metric_.sphere(kept));
    };
    if (complex_.steps() >= wanted) return true;
    caller.report(stage, 0);
    if (!decimation_.run(wanted - complex_.steps(), task, record)) return false;
    while (complex_.steps() < wanted && !options_.keep_topology) {
      const std::uint32_t before = complex_.steps();
      const auto roots = recorder_.roots();
      std::vector<Eigen::Vector3d> centres;
      centres.reserve(roots.size());
      for (const auto slot : roots) centres.push_back(metric_.position(slot));
      decimation_.offer(add_links(links_between_components(roots, centres)));
      if (!decimation_.run(wanted - before, task, record)) return false;
      if (complex_.steps() == before) break;
    }
    return true;
  }
  [[nodiscard]] std::uint32_t vertex_count() const noexcept {
    return static_cast<std::uint32_t>(shape_.positions.size());
  }
  std::uint32_t add_links(std::vector<CollapseComplex::Pair> links) {
    std::erase_if(links, [&](const auto& link) { return complex_.joined(link[0], link[1]); });
    return complex_.add_links(links);
  }

  const HierarchyOptions& options_;
  NormalisedShape shape_;  // without positions and triangles once all is set up
  SqemMetric metric_;
  CollapseComplex complex_;
  Recorder recorder_;
  Decimation<SqemMetric> decimation_;
  std::uint32_t wanted_;
  std::uint32_t collapses_ = 0;  // of those that are kept
};

}  // namespace

Expected<HierarchyBuild> build_hierarchy(const Mesh& mesh, const HierarchyOptions& options, const Task& task) {
  return build_hierarchy_with(nullptr, {mesh}, options, task);
}

Expected<HierarchyBuild> build_hierarchy(const PointSet& points, const HierarchyOptions& options, const Task& task) {
  const auto surface = surface_of(points, task);
  if (!surface) return tl::unexpected(surface.error());
  return build_hierarchy_with(nullptr, {surface->mesh, &surface->points}, options, task);
}

Expected<HierarchyBuild> build_hierarchy_with(SimilarCollapses* similar, const Fitted& shape,
                                              const HierarchyOptions& options, const Task& task) {
  const Mesh& mesh = shape.mesh;
  if (const auto wrong = CollapseComplex::refuses(mesh.positions.size(), mesh.triangles.size()); !wrong.empty())
    return fail(wrong);
  if (const auto wrong = fault(shape, options); !wrong.empty()) return fail(wrong);
  const auto start = Clock::now();
  std::vector<double> curved;
  std::span<const double> weights = options.weights;
  if (weights.empty() && options.importance > 0) {
    auto importance = curvature_importance(mesh, options.importance, task);
    if (!importance) return tl::unexpected(importance.error());
    curved = std::move(*importance);
    weights = curved;
  }
  if (task.stopped()) return cancelled();
  HierarchyOptions settled = options;
  auto builder = std::make_unique<Builder>(shape, settled, weights, similar);
  HierarchyBuild build;
  build.statistics.init_ms = milliseconds_since(start);

  const auto decimating = Clock::now();
  if (!builder->decimate("decimating", task)) return cancelled();
  if (!options.compactness && similar == nullptr) {
    const auto along = builder->cuts_along(mesh, task);
    if (!along) return cancelled();
    if (*along) {
      constexpr double kAcross = 0.01;
      builder.reset();
      settled.compactness = kAcross;
      builder = std::make_unique<Builder>(shape, settled, weights, similar);
      if (!builder->decimate("decimating across", task)) return cancelled();
    }
  }
  build.statistics.compactness = settled.compactness.value_or(0);
  build.statistics.decimate_ms = milliseconds_since(decimating);
  build.statistics.collapses = builder->collapses();

  const NormalisedShape normalised = builder->take_shape();
  Recorder recorder = builder->take_recorder();
  builder.reset();
  auto hierarchy = Hierarchy::assemble(recorder.finish(mesh, normalised));
  if (!hierarchy) return tl::unexpected(hierarchy.error());
  build.hierarchy = std::move(*hierarchy);
  return build;
}

}  // namespace armature::sdk
