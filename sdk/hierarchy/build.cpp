#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include <armature/sdk/hierarchy/build.h>
#include <armature/sdk/mesh/curvature.h>

#include "sdk/hierarchy/collapse_complex.h"
#include "sdk/hierarchy/decimation.h"
#include "sdk/hierarchy/links.h"
#include "sdk/hierarchy/recorder.h"
#include "sdk/hierarchy/sqem_metric.h"

namespace armature::sdk {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// What is wrong with the mesh or the options, or nothing.
std::string fault(const Mesh& mesh, const HierarchyOptions& options) {
  const auto count = [](std::size_t n) { return std::to_string(n); };
  if (mesh.positions.empty()) return "expected a mesh with vertices, found none";
  if (mesh.positions.size() > 0x7FFF'FFFFU || mesh.triangles.size() > 0x2FFF'FFFFU)
    return "expected at most 2^31 - 1 vertices and 2^29 triangles";
  if (!(options.importance >= 0) || !std::isfinite(options.importance)) return "importance: expected 0 or more";
  if (!(options.regularise >= 0) || !std::isfinite(options.regularise)) return "regularise: expected 0 or more";
  if (!(options.enrichment >= 0) || !std::isfinite(options.enrichment)) return "enrichment: expected 0 or more";
  if (!options.weights.empty() && options.weights.size() != mesh.positions.size())
    return "weights: expected one a vertex, " + count(mesh.positions.size()) + ", found " +
           count(options.weights.size());
  for (const double weight : options.weights)
    if (!(weight > 0) || !std::isfinite(weight)) return "weights: expected positive numbers";
  if (!options.labels.empty() && options.labels.size() != mesh.positions.size())
    return "labels: expected one a vertex, " + count(mesh.positions.size()) + ", found " + count(options.labels.size());
  std::vector<bool> seen(options.pinned.empty() ? 0 : mesh.positions.size(), false);
  for (const auto& pin : options.pinned) {
    if (!pin.vertex.valid() || pin.vertex.index() >= seen.size() || seen[pin.vertex.index()])
      return "pinned: expected vertices of the mesh, each once";
    seen[pin.vertex.index()] = true;
    if (pin.sphere && !(pin.sphere->centre.allFinite() && std::isfinite(pin.sphere->radius) && pin.sphere->radius >= 0))
      return "pinned: expected a finite centre and a finite radius that is not negative";
  }
  return {};
}

}  // namespace

Expected<HierarchyBuild> build_hierarchy(const Mesh& mesh, const HierarchyOptions& options, const Task& task) {
  if (const auto wrong = fault(mesh, options); !wrong.empty()) return fail(wrong);
  const auto start = Clock::now();
  std::vector<double> curved;
  std::span<const double> weights = options.weights;
  if (weights.empty() && options.importance > 0) {
    auto importance = curvature_importance(mesh, options.importance, task);
    if (!importance) return tl::unexpected(importance.error());
    weights = curved = std::move(*importance);
  }
  const auto shape = NormalisedShape::of(mesh);
  const auto vertices = static_cast<std::uint32_t>(shape.positions.size());
  SqemMetric metric(shape, {.weights = weights, .regularise = options.regularise});
  for (const auto& [vertex, sphere] : options.pinned) {
    const auto slot = static_cast<std::uint32_t>(vertex.index());
    metric.pin(slot, sphere ? Sphere{(sphere->centre - shape.origin) / shape.scale, sphere->radius / shape.scale}
                            : Sphere{shape.positions[slot], 0});
  }
  CollapseComplex complex(vertices, shape.triangles, links_of_loose_vertices(shape, options.labels));
  Recorder recorder(shape);
  const auto record = [&](std::uint32_t kept, std::uint32_t gone) {
    recorder.record(kept, gone, metric.placement(kept));
  };
  Decimation<SqemMetric> decimation(
      metric, complex,
      {.keep_topology = options.keep_topology, .penalise_flips = options.penalise_flips, .labels = options.labels});
  decimation.offer(0);
  HierarchyBuild build;
  build.statistics.init_ms = milliseconds_since(start);

  const auto decimating = Clock::now();
  const auto wanted = vertices - static_cast<std::uint32_t>(std::clamp<std::size_t>(options.stop_at, 1, vertices));
  if (!decimation.run(wanted, task, record)) return cancelled();
  while (complex.steps() < wanted && !options.keep_topology) {
    const std::uint32_t before = complex.steps();
    const auto roots = recorder.roots();
    std::vector<Eigen::Vector3d> centres;
    centres.reserve(roots.size());
    for (const auto slot : roots) centres.push_back(metric.position(slot));
    auto links = links_between_components(roots, centres);
    std::erase_if(links, [&](const auto& link) { return complex.joined(link[0], link[1]); });
    decimation.offer(complex.add_links(links));
    if (!decimation.run(wanted - before, task, record)) return cancelled();
    if (complex.steps() == before) break;
  }
  build.statistics.decimate_ms = milliseconds_since(decimating);
  build.statistics.collapses = complex.steps();

  auto hierarchy = Hierarchy::assemble(recorder.finish(complex, shape));
  if (!hierarchy) return tl::unexpected(hierarchy.error());
  build.hierarchy = std::move(*hierarchy);
  return build;
}

}  // namespace armature::sdk
