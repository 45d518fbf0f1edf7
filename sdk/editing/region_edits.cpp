#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include <armature/sdk/editing/region_edits.h>
#include <armature/sdk/editing/vertex_edits.h>
#include <armature/sdk/laplacian/laplacian.h>
#include <armature/sdk/laplacian/sparse_factor.h>
#include <armature/sdk/mesh/measures.h>

#include "sdk/editing/edit_region.h"

namespace armature::sdk {
namespace {

/// The reference and the matches, in this order.
Expected<std::vector<EditRegion>> regions_of(const Surface& surface, std::span<const FaceId> reference,
                                             std::span<const Match> matches, const TransportOptions& options) {
  if (!(options.blend >= 0 && options.blend <= 1)) return fail("blend: expected a part of the way, 0 to 1");
  std::vector<EditRegion> regions;
  for (std::size_t k = 0; k <= matches.size(); ++k) {
    auto region = k == 0 ? edit_region(surface, reference, Eigen::Matrix4d::Identity(), options.blend, "reference")
                         : edit_region(surface, matches[k - 1].faces, matches[k - 1].reference_from_match,
                                       options.blend, "match " + std::to_string(k - 1));
    if (!region) return tl::unexpected(region.error());
    regions.push_back(std::move(*region));
  }
  return regions;
}

// A handle holds what is within so much of the radius of a disc as large as the region, firmly in the middle: a single
// vertex would draw more or less of its surroundings with it as the mesh is finer or coarser.
constexpr double kHandle = 0.25, kFirmly = 100;

/// How far a handle draws every vertex: 1 at the vertex nearest to it off the boundary, 0 at the boundary; without a
/// boundary it fades over the region's own size.
Expected<std::vector<double>> drawn_by_handle(const EditRegion& region, const Eigen::Vector3d& handle,
                                              const Task& task) {
  const auto n = static_cast<Eigen::Index>(region.mesh.positions.size());
  Eigen::Index nearest = -1;
  Eigen::VectorXd distance2(n);
  for (Eigen::Index v = 0; v < n; ++v) {
    distance2[v] = (region.mesh.positions[static_cast<std::size_t>(v)] - handle).squaredNorm();
    if (region.inside[static_cast<std::size_t>(v)] == 0) continue;
    if (nearest < 0 || distance2[v] < distance2[nearest]) nearest = v;
  }
  if (nearest < 0) return std::vector<double>(region.mesh.positions.size(), 0.0);  // all boundary
  const Laplacian of_region = laplacian(region.mesh, Adjacency(region.mesh));
  const double area = of_region.mass.sum();
  Eigen::SparseMatrix<double> A = of_region.stiffness;
  const double weight = 1e4 * A.diagonal().mean();
  Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
  const double radius2 = kHandle * kHandle * area / std::numbers::pi + distance2[nearest];
  for (Eigen::Index v = 0; v < n; ++v) {
    A.coeffRef(v, v) += area > 0 ? of_region.mass[v] / area : 1;
    const double within = std::max(0.0, 1 - distance2[v] / radius2);
    if (region.inside[static_cast<std::size_t>(v)] == 0) {
      A.coeffRef(v, v) += weight;
    } else if (radius2 > 0 && within > 0) {
      b[v] = kFirmly / radius2 * within * within * of_region.mass[v];
      A.coeffRef(v, v) += b[v];
    }
  }
  if (!(b.sum() > 0)) A.coeffRef(nearest, nearest) += b[nearest] = weight;
  const auto factor = SparseFactor::of(A, region.mesh.positions, task);
  if (!factor) return tl::unexpected(factor.error());
  factor->solve(b);
  const double most = b[nearest];
  std::vector<double> drawn(region.mesh.positions.size());
  for (std::size_t v = 0; v < drawn.size(); ++v) drawn[v] = most > 0 ? b[static_cast<Eigen::Index>(v)] / most : 0;
  return drawn;
}

/// Does an edit to one region, of which it returns a mesh with new places.
struct Edit {
  const EditRegion& region;
  const MeshTree& reference;  // of the reference's faces
  const Task& task;

  Expected<Mesh> operator()(const DisplaceEdit& edit) const {
    // A mirror image faces as the reference does: normals are its own.
    return displaced(region.mesh, region.inside, edit.distance / region.scale);
  }
  Expected<Mesh> operator()(const SmoothEdit& edit) const {
    return smoothed(region.mesh, laplacian(region.mesh, Adjacency(region.mesh)), region.inside,
                    edit.length / region.scale, task);
  }
  Expected<Mesh> operator()(const HandleEdit& edit) const {
    const auto drawn = drawn_by_handle(region, region.from_reference(edit.point), task);
    if (!drawn) return tl::unexpected(drawn.error());
    const Eigen::Vector3d by = region.direction_from_reference(edit.by);
    Mesh result = region.mesh;
    for (std::size_t v = 0; v < drawn->size(); ++v) result.positions[v] += (*drawn)[v] * by;
    return result;
  }
  Expected<Mesh> operator()(const PaintEdit& edit) const {
    std::vector<double> weights = region.inside;
    for (double& w : weights) w *= edit.strength;
    return painted(region.mesh, weights, edit.colour);
  }
  Expected<Mesh> operator()(const CopyEdit&) const {
    Mesh result = region.mesh;
    for (std::size_t v = 0; v < result.positions.size(); ++v) {
      const Eigen::Vector3d there =
          region.from_reference(reference.closest(region.to_reference(result.positions[v])).point);
      result.positions[v] += region.inside[v] * (there - result.positions[v]);
    }
    return result;
  }
};

/// Takes the regions' vertices into the mesh, the first region that has one.
Mesh with_regions(const Mesh& mesh, std::span<const EditRegion> regions, std::span<const Mesh> edited) {
  Mesh result = mesh;
  const bool colours = !edited.front().vertex_colours.empty();
  if (colours) {
    result.face_colours.clear();
    if (result.vertex_colours.empty()) result.vertex_colours.assign(mesh.positions.size(), kPlainColour);
  }
  std::vector<bool> done(mesh.positions.size(), false);
  for (std::size_t k = 0; k < regions.size(); ++k)
    for (std::size_t v = 0; v < regions[k].vertex_of.size(); ++v) {
      const std::size_t at = regions[k].vertex_of[v].index();
      if (done[at]) continue;
      done[at] = true;
      result.positions[at] = edited[k].positions[v];
      if (colours) result.vertex_colours[at] = edited[k].vertex_colours[v];
    }
  return result;
}

}  // namespace

Expected<Mesh> transported(const Surface& surface, std::span<const FaceId> reference, std::span<const Match> matches,
                           const RegionEdit& edit, const TransportOptions& options, const Task& task) {
  const auto regions = regions_of(surface, reference, matches, options);
  if (!regions) return tl::unexpected(regions.error());
  const MeshTree tree(regions->front().mesh);
  std::vector<Mesh> edited;
  for (const EditRegion& region : *regions) {
    if (task.stopped()) return cancelled();
    auto mesh = std::visit(Edit{region, tree, task}, edit);
    if (!mesh) return tl::unexpected(mesh.error());
    edited.push_back(std::move(*mesh));
  }
  return with_regions(surface.mesh, *regions, edited);
}

Expected<Mesh> made_alike(const Surface& surface, std::span<const FaceId> reference, std::span<const Match> matches,
                          double amount, const TransportOptions& options, const Task& task) {
  const auto regions = regions_of(surface, reference, matches, options);
  if (!regions) return tl::unexpected(regions.error());
  std::vector<MeshTree> laid_on;
  for (const EditRegion& region : *regions) laid_on.emplace_back(region.laid_on());
  std::vector<Mesh> edited;
  for (const EditRegion& region : *regions) {
    if (task.stopped()) return cancelled();
    Mesh& mesh = edited.emplace_back(region.mesh);
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      const Eigen::Vector3d here = region.to_reference(mesh.positions[v]);
      Eigen::Vector3d mean = Eigen::Vector3d::Zero();
      for (const MeshTree& tree : laid_on) mean += tree.closest(here).point / static_cast<double>(laid_on.size());
      mesh.positions[v] += region.inside[v] * amount * region.direction_from_reference(mean - here);
    }
  }
  return with_regions(surface.mesh, *regions, edited);
}

}  // namespace armature::sdk
