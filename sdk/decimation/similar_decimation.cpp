#include <chrono>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>
#include <armature/sdk/decimation/similar_decimation.h>

#include "sdk/decimation/similar_regions.h"
#include "sdk/hierarchy/build_with.h"
#include "sdk/mesh/lengths.h"
#include "sdk/mesh/point_surface.h"

namespace armature::sdk {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

Expected<void> checked(const SimilarityOptions& options) {
  if (!(options.threshold >= 0) || !std::isfinite(options.threshold))
    return fail("similarity threshold: expected 0 or more");
  if (!(options.cost_ratio >= 1) || !std::isfinite(options.cost_ratio)) return fail("cost ratio: expected 1 or more");
  if (!(options.area_ratio >= 1) || !std::isfinite(options.area_ratio)) return fail("area ratio: expected 1 or more");
  if (options.scales == 0 || options.scales > 64) return fail("scales: expected 1 to 64");
  return {};
}

/// Points in a unit about as large as all of them: likeness does not depend on it, but powers of lengths stay numbers.
/// Returns the unit.
double shrink(std::vector<Eigen::Vector3d>& positions) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : positions) box.extend(p);
  const double unit = box.isEmpty() ? 1 : unit_near(length_of(box.diagonal()));
  for (Eigen::Vector3d& p : positions) p /= unit;
  return unit;
}

Mesh shrunk(Mesh mesh) {
  shrink(mesh.positions);
  return mesh;
}

PointSet shrunk(PointSet points) {
  const double unit = shrink(points.positions);
  for (double& area : points.areas) area = area / unit / unit;
  return points;
}

bool does_one_at_a_time(const SimilarityOptions& options) {
  return options.threshold == 0 && !options.adaptive;
}

/// What tells likeness of regions by a descriptor, and what it took to find counterparts.
Expected<std::unique_ptr<SimilarRegions>> similar_regions(const Mesh& mesh, const Descriptor& descriptor,
                                                          const SimilarityOptions& options, double& counterparts_ms,
                                                          const Task& task) {
  const auto start = Clock::now();
  Correspondence correspondence;
  if (options.in_step) {
    auto found = find_correspondence(shrunk(mesh), task);
    if (!found) return tl::unexpected(found.error());
    correspondence = std::move(*found);
  }
  counterparts_ms = milliseconds_since(start);
  return std::make_unique<SimilarRegions>(descriptor, correspondence, options);
}

Expected<std::unique_ptr<Descriptor>> gls_of(PointSet points, const SimilarityOptions& options, const Task& task) {
  std::vector<double> scales = gls_scales(points, options.scales);
  // At one place everything is alike.
  if (scales.empty()) scales = {1};
  const auto gls = GrowingLeastSquares::build(std::move(points), {.scales = std::move(scales)}, task);
  if (!gls) return tl::unexpected(gls.error());
  switch (options.descriptor) {
    case RegionDescriptor::GlsMean: return gls_descriptor(*gls, GlsAggregation::Mean, task);
    case RegionDescriptor::ScaledGlsHistograms: return gls_descriptor(*gls, GlsAggregation::ScaledHistograms, task);
    case RegionDescriptor::MergedGls: return gls_descriptor(*gls, GlsAggregation::Merged, task);
    default: return gls_descriptor(*gls, GlsAggregation::Histograms, task);
  }
}

Expected<SimilarBuild> build_similar(const Fitted& shape, const Descriptor& descriptor, const HierarchyOptions& options,
                                     const SimilarityOptions& similarity, const Task& task) {
  if (auto fine = checked(similarity); !fine) return tl::unexpected(fine.error());
  if (descriptor.size() != shape.mesh.positions.size())
    return fail("descriptor: expected one of the mesh's " + std::to_string(shape.mesh.positions.size()) +
                " vertices, found one of " + std::to_string(descriptor.size()));
  SimilarBuild result;
  std::unique_ptr<SimilarRegions> regions;
  if (!does_one_at_a_time(similarity)) {
    auto made = similar_regions(shape.mesh, descriptor, similarity, result.counterparts_ms, task);
    if (!made) return tl::unexpected(made.error());
    regions = std::move(*made);
  }
  auto build = build_hierarchy_with(regions.get(), shape, options, task);
  if (!build) return tl::unexpected(build.error());
  result.build = std::move(*build);
  return result;
}

Expected<SimilarBuild> build_similar(const Fitted& shape, const HierarchyOptions& options,
                                     const SimilarityOptions& similarity, const Task& task) {
  if (auto fine = checked(similarity); !fine) return tl::unexpected(fine.error());
  if (does_one_at_a_time(similarity) || shape.mesh.positions.empty()) {
    auto plain = build_hierarchy_with(nullptr, shape, options, task);
    if (!plain) return tl::unexpected(plain.error());
    return SimilarBuild{.build = std::move(*plain)};
  }
  const auto start = Clock::now();
  const auto descriptor = shape.points != nullptr ? region_descriptor(*shape.points, similarity, task)
                                                  : region_descriptor(shape.mesh, similarity, task);
  if (!descriptor) return tl::unexpected(descriptor.error());
  const double descriptor_ms = milliseconds_since(start);
  auto result = build_similar(shape, **descriptor, options, similarity, task);
  if (result) result->descriptor_ms = descriptor_ms;
  return result;
}

}  // namespace

Expected<std::unique_ptr<Descriptor>> region_descriptor(const Mesh& mesh, const SimilarityOptions& options,
                                                        const Task& task) {
  if (auto fine = checked(options); !fine) return tl::unexpected(fine.error());
  const Mesh scaled = shrunk(mesh);
  if (options.descriptor == RegionDescriptor::Quadric) return quadric_descriptor(scaled);
  return gls_of(point_set_of(scaled), options, task);
}

Expected<std::unique_ptr<Descriptor>> region_descriptor(const PointSet& points, const SimilarityOptions& options,
                                                        const Task& task) {
  if (auto fine = checked(options); !fine) return tl::unexpected(fine.error());
  if (auto fine = validate(points); !fine) return tl::unexpected(fine.error());
  PointSet scaled = shrunk(points);
  if (options.descriptor == RegionDescriptor::Quadric) return quadric_descriptor(scaled);
  return gls_of(std::move(scaled), options, task);
}

Expected<SimilarBuild> build_similar_hierarchy(const Mesh& mesh, const Descriptor& descriptor,
                                               const HierarchyOptions& options, const SimilarityOptions& similarity,
                                               const Task& task) {
  return build_similar({mesh}, descriptor, options, similarity, task);
}

Expected<SimilarBuild> build_similar_hierarchy(const Mesh& mesh, const HierarchyOptions& options,
                                               const SimilarityOptions& similarity, const Task& task) {
  return build_similar({mesh}, options, similarity, task);
}

Expected<SimilarBuild> build_similar_hierarchy(const PointSet& points, const HierarchyOptions& options,
                                               const SimilarityOptions& similarity, const Task& task) {
  const auto start = Clock::now();
  const auto surface = surface_of(points, task);
  if (!surface) return tl::unexpected(surface.error());
  const double joining_ms = milliseconds_since(start);
  auto result = build_similar({surface->mesh, &surface->points}, options, similarity, task);
  if (result) result->build.statistics.init_ms += joining_ms;
  return result;
}

Expected<SimilarMesh> decimate_similar_mesh(const Mesh& mesh, const DecimateMeshOptions& options,
                                            const SimilarityOptions& similarity, const Task& task) {
  if (auto fine = checked(similarity); !fine) return tl::unexpected(fine.error());
  SimilarMesh result;
  std::unique_ptr<Descriptor> descriptor;
  std::unique_ptr<SimilarRegions> regions;
  if (!does_one_at_a_time(similarity) && !mesh.positions.empty()) {
    const auto start = Clock::now();
    auto made = region_descriptor(mesh, similarity, task);
    if (!made) return tl::unexpected(made.error());
    descriptor = std::move(*made);
    result.descriptor_ms = milliseconds_since(start);
    auto alike = similar_regions(mesh, *descriptor, similarity, result.counterparts_ms, task);
    if (!alike) return tl::unexpected(alike.error());
    regions = std::move(*alike);
  }
  const auto start = Clock::now();
  std::vector<std::uint32_t> steps;
  auto decimated = decimate_mesh_with(regions.get(), steps, mesh, options, task);
  if (!decimated) return tl::unexpected(decimated.error());
  result.decimated = std::move(*decimated);
  result.decimate_ms = milliseconds_since(start);
  result.steps = regions ? steps.size() : mesh.positions.size() - result.decimated.mesh.positions.size();
  return result;
}

}  // namespace armature::sdk
