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

std::vector<FaceId> PatchReference::extent(const FaceGraph& graph, const PatchFit& laid) const {
  const Surface& target = graph.surface();
  const Mesh& mesh = target.mesh;
  const Matrix4d reference_from_target = laid.target_from_reference.inverse();
  const SurfacePoint start = target.tree.closest(apply(laid.target_from_reference, around_.centre));
  if (!start.face.valid()) return {};
  const double reach = (1 + kReach) * ball_.radius;
  // Where the patch's boundary is far, what holds for one face holds for those around it.
  struct Answer {
    Vector3d at;
    double valid_within;
    bool near, inside;  // the surface of the reference; the patch
    FaceId nearest;     // of the reference
  };
  const auto ask = [&](FaceId face, const Vector3d& at, const Answer& beside) {
    const SurfacePoint on = closest_near(*graph_, grid_, beside.nearest, at, ball_.radius);
    if (!(on.distance <= kReach * ball_.radius)) return Answer{at, 0, false, false, on.face};
    double to_border = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t corner = surface_->mesh.triangle(on.face)[k].index();
      to_border += on.barycentric[static_cast<Eigen::Index>(k)] * static_cast<double>(to_border_[corner]);
    }
    const Vector3d facing = reference_from_target.topLeftCorner<3, 3>() * area_vector(mesh, face);
    const bool inside = shares_.at(on) > 0.5 && facing.dot(area_vector(surface_->mesh, on.face)) >= 0;
    return Answer{at, kSure * std::max(0.0, to_border), true, inside, on.face};
  };
  const auto at_centre = surface_->adjacency.faces(ball_.centre);
  std::vector<Answer> answers = {{around_.centre, 0, false, false, at_centre.empty() ? FaceId() : at_centre.front()}};
  std::vector<std::pair<FaceId, std::size_t>> inside;  // what is still to be passed, with answers
  std::vector<std::pair<FaceId, std::size_t>> outside;
  std::vector<bool> seen(mesh.triangles.size());
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
    (answers[answer].inside ? inside : outside).emplace_back(face, answer);
  };
  const auto pass = [&](const std::pair<FaceId, std::size_t>& from) {
    for (const FaceId next : graph.beside(from.first)) go_to(next, from.second);
  };
  // Piece by piece; outside of them only as long as there may be a larger one.
  const double half = 0.5 * area_ * laid.scale * laid.scale;
  std::vector<FaceId> largest;
  double most = 0;
  go_to(start.face, 0);
  for (std::size_t passed = 0; most < half;) {
    if (inside.empty()) {
      if (passed == outside.size()) break;
      pass(std::pair(outside[passed++]));
      continue;
    }
    double area = 0;
    std::vector<FaceId> piece;
    for (std::size_t i = 0; i < inside.size(); ++i) {
      piece.push_back(inside[i].first);
      area += area_vector(mesh, inside[i].first).norm();
      pass(std::pair(inside[i]));
    }
    inside.clear();
    if (area > most) {
      most = area;
      largest = std::move(piece);
    }
  }
  std::ranges::sort(largest);
  return largest;
}

}  // namespace armature::sdk
