#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>

#include <Eigen/Dense>
#include <armature/sdk/mesh/measures.h>
#include <tbb/parallel_for.h>

#include "sdk/expansion/patch_registration.h"

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

void PatchReference::measure_border(const FaceGraph& graph) {
  const Mesh& mesh = surface_->mesh;
  const double reach = (1 + 2 * kReach) * ball_.radius;  // as far as a face may lie from a point that is asked about
  const auto near = graph.flood(surface_->adjacency.faces(ball_.centre),
                                [&](FaceId face) { return graph.touches(face, around_.centre, reach); });
  std::vector<VertexId> corners;
  for (const FaceId face : near)
    for (const VertexId v : mesh.triangle(face))
      if (to_border_[v.index()] < 0) {
        to_border_[v.index()] = 0;
        corners.push_back(v);
      }
  tbb::parallel_for(std::size_t{0}, corners.size(), [&](std::size_t i) {
    to_border_[corners[i].index()] = static_cast<float>(border_.closest(mesh.position(corners[i])).distance);
  });
}

std::vector<FaceId> PatchReference::extent(const FaceGraph& graph, const PatchFit& registration) const {
  const Surface& target = graph.surface();
  const Mesh& mesh = target.mesh;
  const Matrix4d reference_from_target = registration.target_from_reference.inverse();
  const SurfacePoint start = target.tree.closest(apply(registration.target_from_reference, around_.centre));
  if (!start.face.valid()) return {};
  const double reach = (1 + kReach) * ball_.radius;
  // Where the patch's boundary is far, what holds for one face holds for those around it.
  struct Answer {
    Vector3d at;
    double valid_within;
    bool near, inside;  // the surface of the reference; the patch
    FaceId nearest = {};
  };
  const auto ask = [&](FaceId face, const Vector3d& at, const Answer& beside) {
    const SurfacePoint on = surface_->tree.closest(at, {.within = kReach * ball_.radius, .hint = beside.nearest});
    if (!on.face.valid()) return Answer{at, 0, false, false, beside.nearest};
    double to_border = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t corner = surface_->mesh.triangle(on.face)[k].index();
      to_border += on.barycentric[static_cast<Eigen::Index>(k)] * static_cast<double>(to_border_[corner]);
    }
    const Vector3d facing = reference_from_target.topLeftCorner<3, 3>() * area_vector(mesh, face);
    const bool inside = shares_.at(on) > 0.5 && facing.dot(area_vector(surface_->mesh, on.face)) >= 0;
    return Answer{at, kSure * std::max(0.0, to_border), true, inside, on.face};
  };
  std::vector<Answer> answers = {{around_.centre, 0, false, false}};
  std::vector<std::pair<FaceId, std::size_t>> reached;  // with their answers
  std::vector<bool> seen(mesh.triangles.size());
  std::vector<bool> is_inside(mesh.triangles.size());
  const auto go_to = [&](FaceId face, std::size_t answer) {
    if (seen[face.index()]) return;
    seen[face.index()] = true;
    const Vector3d at = apply(reference_from_target, graph.middle(face));
    if (face != start.face && (at - around_.centre).squaredNorm() >= reach * reach) return;
    const Answer& beside = answers[answer];
    if ((at - beside.at).squaredNorm() >= beside.valid_within * beside.valid_within) {
      answers.push_back(ask(face, at, beside));
      answer = answers.size() - 1;
    }
    if (!answers[answer].near && face != start.face) return;  // nor does what lies behind it
    reached.emplace_back(face, answer);
    is_inside[face.index()] = answers[answer].inside;
  };
  go_to(start.face, 0);
  for (std::size_t i = 0; i < reached.size(); ++i) {
    const auto [face, answer] = reached[i];
    for (const FaceId next : graph.beside(face)) go_to(next, answer);
  }

  std::vector<FaceId> largest;
  double most = -1;
  for (const auto& [face, answer] : reached) {
    if (!is_inside[face.index()]) continue;
    auto piece = graph.flood(std::span(&face, 1), [&](FaceId f) { return bool{is_inside[f.index()]}; });
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
