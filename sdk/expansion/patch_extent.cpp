#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>

#include <Eigen/Dense>
#include <armature/sdk/mesh/measures.h>

#include "sdk/expansion/patch_registration.h"
#include "sdk/selection/flood.h"

namespace armature::sdk {
namespace {

using Eigen::Matrix4d;
using Eigen::Vector3d;

constexpr double kReach = 0.2;  // how far a face may lie from the patch that it belongs to, of the radius
constexpr double kSure = 0.5;   // of the way to the border of the patch, all is on the same side

}  // namespace

Mesh border_of(const Surface& surface, std::span<const FaceId> patch) {
  Mesh border{.positions = surface.mesh.positions};
  std::vector<bool> in_patch(surface.mesh.triangles.size());
  for (const FaceId face : patch) in_patch[face.index()] = true;
  for (const FaceId face : patch)
    for (const EdgeId edge : surface.adjacency.edges(face)) {
      if (!edge.valid()) continue;
      const auto sharing = surface.adjacency.faces(edge);
      const auto& [a, b] = surface.adjacency.edge(edge);
      if (std::ranges::any_of(sharing, [&](FaceId other) { return !in_patch[other.index()]; }))
        border.triangles.push_back({a, b, b});
    }
  return border;
}

std::vector<FaceId> PatchReference::extent(const Surface& target, const Registration& registration) const {
  const Mesh& mesh = target.mesh;
  const Matrix4d reference_from_target = registration.target_from_reference.inverse();
  const SurfacePoint start = target.tree.closest(apply(registration.target_from_reference, around_.centre));
  if (!start.face.valid()) return {};
  const double reach = (1 + kReach) * ball_.radius;
  // Where the patch's boundary is far, what holds for one face holds for those around it.
  struct Answer {
    Vector3d at;
    double valid_within;
    bool inside;
    FaceId nearest = {};
    FaceId nearest_border = {};
  };
  const auto ask = [&](FaceId face, const Vector3d& at, const Answer& beside) {
    const SurfacePoint on = surface_->tree.closest(at, {.within = kReach * ball_.radius, .hint = beside.nearest});
    const SurfacePoint border = border_.closest(at, {.hint = beside.nearest_border});
    double share = 0;
    for (std::size_t k = 0; k < 3 && on.face.valid(); ++k)
      share += on.barycentric[static_cast<Eigen::Index>(k)] * share_[surface_->mesh.triangle(on.face)[k].index()];
    const Vector3d facing = reference_from_target.topLeftCorner<3, 3>() * area_vector(mesh, face);
    const bool inside = share > 0.5 && facing.dot(area_vector(surface_->mesh, on.face)) >= 0;
    return Answer{at, kSure * border.distance, inside, on.face.valid() ? on.face : beside.nearest, border.face};
  };
  std::vector<Answer> answers = {{around_.centre, 0, false}};
  std::vector<std::pair<FaceId, std::size_t>> reached;  // with their answers
  std::vector<bool> seen(mesh.triangles.size());
  std::vector<bool> is_inside(mesh.triangles.size());
  const auto go_to = [&](FaceId face, std::size_t answer) {
    if (seen[face.index()]) return;
    seen[face.index()] = true;
    const Vector3d at = apply(reference_from_target, middle(mesh, face));
    if (face != start.face && (at - around_.centre).squaredNorm() >= reach * reach) return;
    const Answer& beside = answers[answer];
    if ((at - beside.at).squaredNorm() >= beside.valid_within * beside.valid_within) {
      answers.push_back(ask(face, at, beside));
      answer = answers.size() - 1;
    }
    reached.emplace_back(face, answer);
    is_inside[face.index()] = answers[answer].inside;
  };
  go_to(start.face, 0);
  for (std::size_t i = 0; i < reached.size(); ++i) {
    const auto [face, answer] = reached[i];
    for (const EdgeId edge : target.adjacency.edges(face))
      if (edge.valid())
        for (const FaceId next : target.adjacency.faces(edge)) go_to(next, answer);
  }

  std::vector<FaceId> largest;
  double most = -1;
  for (const auto& [face, answer] : reached) {
    if (!is_inside[face.index()]) continue;
    auto piece = flood(target.adjacency, std::span(&face, 1), mesh.triangles.size(),
                       [&](FaceId f) { return bool{is_inside[f.index()]}; });
    double area = 0;
    for (const FaceId f : piece) {
      is_inside[f.index()] = false;
      area += area_vector(mesh, f).norm();
    }
    if (area > most) {
      most = area;
      largest = std::move(piece);
    }
  }
  std::ranges::sort(largest);
  return largest;
}

}  // namespace armature::sdk
