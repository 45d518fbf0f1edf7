#include <algorithm>
#include <cmath>
#include <string>

#include <armature/sdk/distance/sphere_mesh_tree.h>
#include <armature/sdk/mesh/adjacency.h>
#include <armature/sdk/spheremesh/make_sphere_mesh.h>
#include <armature/sdk/spheremesh/refine.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "sdk/mesh/normalised_shape.h"
#include "sdk/spheremesh/surface_bounds.h"
#include "sdk/spheremesh/union_search.h"

namespace armature::sdk {
namespace {

/// The mesh in the unit frame, its faces outward.
Mesh unit_mesh(const NormalisedShape& shape) {
  Mesh mesh;
  mesh.positions = shape.positions;
  mesh.triangles.reserve(shape.triangles.size());
  for (const auto& [a, b, c] : shape.triangles) mesh.triangles.push_back({VertexId(a), VertexId(b), VertexId(c)});
  return mesh;
}

std::size_t boundary_edges(const Mesh& mesh) {
  const Adjacency adjacency(mesh);
  std::size_t count = 0;
  for (std::size_t e = 0; e < adjacency.edge_count(); ++e) count += adjacency.faces(EdgeId(e)).size() == 1 ? 1U : 0U;
  return count;
}

Expected<void> check(const SphereMesh& start, const RefineOptions& options) {
  const std::size_t count = start.spheres.size();
  const auto names_all = [&](const auto& simplices) {
    return std::all_of(simplices.begin(), simplices.end(), [&](const auto& ids) {
      return std::all_of(ids.begin(), ids.end(), [&](SphereId id) { return id.index() < count; });
    });
  };
  if (!names_all(start.edges)) return fail("refine: an edge names a sphere that is not there");
  if (!names_all(start.triangles)) return fail("refine: a triangle names a sphere that is not there");
  for (std::size_t k = 0; k < count; ++k) {
    const Sphere& s = start.spheres[k];
    if (!s.centre.allFinite() || !(s.radius >= 0) || !std::isfinite(s.radius))
      return fail("refine: sphere " + std::to_string(k) + " is not finite or has a negative radius");
  }
  for (const SphereId id : options.pinned)
    if (id.index() >= count)
      return fail("refine: sphere " + std::to_string(id.index()) + " is pinned, but there are " +
                  std::to_string(count));
  if (options.rounds.value_or(0) < 0 || options.steps < 0) return fail("refine: rounds and steps must not be negative");
  if (!(options.tail >= 0) || !std::isfinite(options.tail)) return fail("refine: tail must be finite and not negative");
  return {};
}

}  // namespace

Expected<SphereMesh> refine(const Mesh& mesh, const SphereMesh& start, const RefineOptions& options, const Task& task) {
  if (const Expected<void> checked = check(start, options); !checked) return tl::unexpected(checked.error());
  SphereMesh shape = make_sphere_mesh(start.spheres, start.edges, start.triangles);
  if (shape.spheres.empty() || mesh.triangles.empty()) return shape;
  if (options.mode == FitMode::Inner) {
    if (const std::size_t open = boundary_edges(mesh); open > 0)
      return fail("refine: an inner fit needs a closed mesh; " + std::to_string(open) + " edges have one face only");
  }

  const NormalisedShape normalised = NormalisedShape::of(mesh);
  const Mesh unit = unit_mesh(normalised);
  for (Sphere& s : shape.spheres) {
    s.centre = (s.centre - normalised.origin) / normalised.scale;
    s.radius /= normalised.scale;
  }
  constexpr std::size_t kFewest = 2500;
  constexpr std::size_t kPerSphere = 50;
  const std::size_t samples =
      options.samples > 0 ? options.samples : std::max(kFewest, kPerSphere * shape.spheres.size());
  UnionFit fit(unit, samples);
  if (fit.samples().points.empty()) return start;
  if (task.stopped()) return cancelled();

  std::vector<bool> fixed(shape.spheres.size(), false);
  for (const SphereId id : options.pinned) fixed[id.index()] = true;
  fit.loss.tail = options.tail;
  constexpr double kForbidden = 20;
  if (options.mode == FitMode::Inner) fit.loss.outside = kForbidden;
  if (options.mode == FitMode::Outer) fit.loss.missing = kForbidden;
  // Far is what is several times the mean distance, which falls with the number of spheres.
  const UnionGauge start_gauge(shape);
  const OuterSpace start_outer(start_gauge);
  if (task.stopped()) return cancelled();
  const FitError before = fit.error(start_gauge, start_outer);
  fit.loss.far = std::clamp(2.5 * (before.forward + before.back), 2e-3, 0.05);
  constexpr std::size_t kMany = 75;
  const bool many = shape.spheres.size() >= kMany;
  const SearchEffort effort{.rounds = options.rounds.value_or(many ? 3 : 2),
                            .first_steps = many ? 2 * options.steps : options.steps,
                            .steps = options.steps};
  search(fit, shape, effort, fixed, task);
  if (task.stopped()) return cancelled();

  constexpr double kPart = 5e-4;
  if (options.mode == FitMode::Inner) retreat(unit, shape, fixed, kPart);
  if (options.mode == FitMode::Outer) enclose(unit, shape, fixed, kPart);
  const double rounding = options.mode == FitMode::Outer ? 1e-9 : 0;
  for (std::size_t k = 0; k < shape.spheres.size(); ++k) {
    Sphere& s = shape.spheres[k];
    s.centre = normalised.origin + normalised.scale * s.centre;
    s.radius = normalised.scale * (s.radius + rounding);
    if (fixed[k]) s = start.spheres[k];
  }
  return shape;
}

std::vector<SphereId> nearest_spheres(const Mesh& mesh, const SphereMesh& shape) {
  const SphereMeshTree tree(shape);
  std::vector<SphereId> nearest(mesh.positions.size());
  constexpr std::size_t kGrain = 256;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, nearest.size(), kGrain),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t k = range.begin(); k < range.end(); ++k) {
                        const NearestSphere found = tree.nearest(mesh.positions[k]);
                        Eigen::Index most = 0;
                        found.weights.maxCoeff(&most);
                        nearest[k] = found.spheres[static_cast<std::size_t>(most)];
                      }
                    });
  return nearest;
}

}  // namespace armature::sdk
