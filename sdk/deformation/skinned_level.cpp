#include <algorithm>
#include <cassert>
#include <memory>
#include <utility>

#include <armature/sdk/deformation/skinned_level.h>
#include <armature/sdk/distance/sphere_mesh_tree.h>
#include <armature/sdk/mesh/measures.h>

#include "sdk/deformation/kept_volume.h"

namespace armature::sdk {

using Eigen::Vector3d;

SkinnedLevel::SkinnedLevel(SkinWeights weights, SphereMesh shape, Mesh mesh)
    : weights_(std::move(weights)), shape_(std::move(shape)), mesh_(std::move(mesh)) {
  assert(weights_.columns.size() == shape_.spheres.size() && weights_.totals.size() == mesh_.positions.size());
}

SkinnedLevel::SkinnedLevel(SkinnedLevel&&) noexcept = default;
SkinnedLevel& SkinnedLevel::operator=(SkinnedLevel&&) noexcept = default;
SkinnedLevel::~SkinnedLevel() = default;

void SkinnedLevel::set_level(SkinWeights weights, SphereMesh shape) {
  weights_ = std::move(weights);
  shape_ = std::move(shape);
  outward_.clear();
  if (kept_) kept_->forget_rest();
}

void SkinnedLevel::set_rest(std::vector<Vector3d>& positions, std::vector<Sphere> spheres) {
  assert(positions.size() == mesh_.positions.size() && spheres.size() == shape_.spheres.size());
  mesh_.positions.swap(positions);
  shape_.spheres = std::move(spheres);
  outward_.clear();
  if (kept_) kept_->forget_rest();
}

void SkinnedLevel::find_outward(const WeightColumn& column) {
  if (outward_.empty()) {
    outward_ = vertex_normals(mesh_);
    found_.assign(outward_.size(), false);
  }
  const SphereMeshTree tree(shape_);
  for (const VertexId vertex : column.vertices) {
    if (found_[vertex.index()]) continue;
    found_[vertex.index()] = true;
    const Sphere nearest = tree.nearest(mesh_.position(vertex)).sphere;
    const Vector3d from_middle = mesh_.position(vertex) - nearest.centre;
    const double distance = from_middle.norm();
    // Where the shape is a sheet, along its normal.
    constexpr double kSheet = 0.25;
    if (nearest.radius > kSheet * distance) outward_[vertex.index()] = from_middle / std::max(nearest.radius, distance);
  }
}

void SkinnedLevel::move(std::span<const SphereMotion> motions, Blend blend, std::span<Vector3d> out, Volume volume) {
  if (std::ranges::none_of(motions, [](const SphereMotion& motion) { return motion.swelling() != 0; })) {
    const auto is_stiff = [](const SphereMotion& motion) { return motion.scale == 1; };
    const bool keeps =
        blend == Blend::DualQuaternions && ((volume == Volume::Kept && std::ranges::all_of(motions, is_stiff)) ||
                                            (volume == Volume::KeptByTurns && only_turn(motions)));
    if (keeps && !kept_) kept_ = std::make_unique<KeptVolume>(mesh_);
    if (keeps && kept_->closed()) {
      if (!kept_->has_rest()) kept_->set_rest(mesh_, weights_, shape_.spheres);
      kept_->move(weights_, motions, mesh_.positions, out);
    } else {
      skin(weights_, motions, blend, mesh_.positions, out);
    }
    return;
  }
  std::ranges::copy(mesh_.positions, out.begin());
  for (std::size_t s = 0; s < motions.size(); ++s) {
    const double swelling = motions[s].swelling();
    if (swelling == 0) continue;
    const WeightColumn& column = *weights_.columns[s];
    find_outward(column);
    for (std::size_t i = 0; i < column.vertices.size(); ++i) {
      const std::size_t v = column.vertices[i].index();
      out[v] += static_cast<double>(column.weights[i]) / weights_.totals[v] * swelling * outward_[v];
    }
  }
  skin(weights_, motions, blend, out, out);
}

}  // namespace armature::sdk
