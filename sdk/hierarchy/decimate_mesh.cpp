#include <cmath>
#include <numeric>

#include <armature/sdk/hierarchy/decimate_mesh.h>

#include "sdk/hierarchy/build_with.h"
#include "sdk/hierarchy/decimation.h"
#include "sdk/hierarchy/links.h"
#include "sdk/hierarchy/qem_metric.h"

namespace armature::sdk {

Expected<DecimatedMesh> decimate_mesh(const Mesh& mesh, const DecimateMeshOptions& options, const Task& task) {
  std::vector<std::uint32_t> steps;
  return decimate_mesh_with(nullptr, steps, mesh, options, task);
}

Expected<DecimatedMesh> decimate_mesh_with(SimilarCollapses* similar, std::vector<std::uint32_t>& steps,
                                           const Mesh& mesh, const DecimateMeshOptions& options, const Task& task) {
  if (const auto wrong = CollapseComplex::refuses(mesh.positions.size(), mesh.triangles.size()); !wrong.empty())
    return fail(wrong);
  if (options.vertices == 0) return fail("vertices: expected 1 or more");
  if (!(options.boundary_weight >= 0) || !std::isfinite(options.boundary_weight))
    return fail("boundary weight: expected 0 or more");
  const auto shape = NormalisedShape::of(mesh);
  const auto count = static_cast<std::uint32_t>(shape.positions.size());
  QemMetric metric(shape, options.boundary_weight);
  CollapseComplex complex(count, shape.triangles, links_of_loose_vertices(shape, {}));
  Decimation<QemMetric> decimation(
      metric, complex, {.keep_topology = options.keep_topology, .penalise_flips = options.penalise_flips}, similar);
  decimation.offer(0);

  std::vector<std::uint32_t> into(count);  // chains of slots, each ending at one that is in use
  std::iota(into.begin(), into.end(), 0U);
  const auto wanted = count - static_cast<std::uint32_t>(std::min<std::size_t>(options.vertices, count));
  if (!decimation.run(wanted, task, [&](std::uint32_t kept, std::uint32_t gone) { into[gone] = kept; }))
    return cancelled();
  steps = decimation.steps();

  DecimatedMesh result;
  std::vector<VertexId> vertex_in(count);  // by slot
  for (std::uint32_t slot = 0; slot < count; ++slot) {
    if (into[slot] != slot) continue;
    vertex_in[slot] = VertexId(result.mesh.positions.size());
    result.mesh.positions.push_back(complex.steps() == 0 ? mesh.positions[slot]
                                                         : shape.origin + shape.scale * metric.position(slot));
  }
  result.came_to.reserve(count);
  for (std::uint32_t v = 0; v < count; ++v) {
    std::uint32_t slot = v;
    while (into[slot] != slot) slot = into[slot] = into[into[slot]];
    result.came_to.push_back(vertex_in[slot]);
  }
  const auto deaths = complex.take_deaths();
  for (std::size_t t = 0; t < deaths.size(); ++t) {
    if (deaths[t] != kNoIndex) continue;
    auto& triangle = result.mesh.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) triangle[k] = result.came_to[mesh.triangles[t][k].index()];
  }
  return result;
}

}  // namespace armature::sdk
