#include "sdk/expansion/face_graph.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <tbb/parallel_for.h>

#include "sdk/distance/facet.h"

namespace armature::sdk {

using Eigen::Vector3d;

FaceGraph::FaceGraph(const Surface& surface) : surface_(&surface), nodes_(surface.mesh.triangles.size() + 1) {
  const Mesh& mesh = surface.mesh;
  const Adjacency& adjacency = surface.adjacency;
  const std::size_t count = mesh.triangles.size();
  for (std::size_t f = 0; f < count; ++f) {
    std::size_t beside = 0;
    for (const EdgeId edge : adjacency.edges(FaceId(f)))
      if (edge.valid()) beside += adjacency.faces(edge).size() - 1;
    nodes_[f + 1].first = nodes_[f].first + static_cast<std::uint32_t>(beside);
  }
  beside_.resize(nodes_[count].first);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t f) {
    const FaceId face(f);
    Node& node = nodes_[f];
    node.middle = sdk::middle(mesh, face);
    double spread = 0;
    for (std::size_t k = 0; k < 3; ++k) spread = std::max(spread, (mesh.corner(face, k) - node.middle).norm());
    node.spread = std::nextafter(static_cast<float>(spread), std::numeric_limits<float>::infinity());
    std::size_t next = node.first;
    for (const EdgeId edge : adjacency.edges(face))
      if (edge.valid())
        for (const FaceId other : adjacency.faces(edge))
          if (other != face) beside_[next++] = other;
  });
}

SurfacePoint FaceGraph::closest_from(FaceId start, const Vector3d& point) const noexcept {
  const Mesh& mesh = surface_->mesh;
  SurfacePoint nearest;
  Facet::Place place;
  double least2 = std::numeric_limits<double>::infinity();
  const auto look_at = [&](FaceId face) {
    const Facet facet(mesh.corner(face, 0), mesh.corner(face, 1), mesh.corner(face, 2));
    const Facet::Place there = facet.closest(point);
    const Vector3d at = facet.at(there);
    const double distance2 = (at - point).squaredNorm();
    if (!(distance2 < least2)) return;
    least2 = distance2;
    place = there;
    nearest.face = face;
    nearest.point = at;
  };
  look_at(start);
  if (!nearest.face.valid()) return nearest;
  const Adjacency& adjacency = surface_->adjacency;
  // Corner by corner first, which is cheap.
  const auto within = [&] { return place.v > 0 && place.w > 0 && place.v != 1 - place.w; };
  if (!within()) {
    const auto squared_distance = [&](VertexId v) { return (mesh.position(v) - point).squaredNorm(); };
    VertexId corner;
    double corner2 = std::numeric_limits<double>::infinity();
    const auto step_to = [&](VertexId next) {
      const double distance2 = squared_distance(next);
      if (!(distance2 < corner2)) return;
      corner2 = distance2;
      corner = next;
    };
    for (const VertexId v : mesh.triangle(start)) step_to(v);
    for (VertexId from; from != corner;) {
      from = corner;
      for (const VertexId next : adjacency.neighbours(from)) step_to(next);
    }
    for (const FaceId face : adjacency.faces(corner)) look_at(face);
  }
  for (FaceId from; from != nearest.face;) {
    from = nearest.face;
    const auto [v, w] = place;
    if (within()) break;  // it is farther to all sides
    if ((v == 0 && w == 0) || v == 1 || w == 1) {
      const VertexId corner = mesh.triangle(from)[v == 1 ? 1 : w == 1 ? 2 : 0];
      for (const FaceId next : adjacency.faces(corner)) look_at(next);
    } else if (const EdgeId side = adjacency.edges(from)[w == 0 ? 0 : v == 0 ? 2 : 1]; side.valid()) {
      for (const FaceId next : adjacency.faces(side))
        if (next != from) look_at(next);
    }
  }
  nearest.barycentric = {std::max(0.0, 1 - place.v - place.w), place.v, place.w};
  nearest.distance = std::sqrt(least2);
  return nearest;
}

bool FaceGraph::touches(FaceId face, const Vector3d& centre, double radius) const noexcept {
  const Node& node = nodes_[face.index()];
  const double distance = (node.middle - centre).norm();
  const auto spread = static_cast<double>(node.spread);
  if (distance > radius + spread) return false;
  if (distance <= radius) return true;
  const Mesh& mesh = surface_->mesh;
  return std::ranges::any_of(mesh.triangle(face),
                             [&](VertexId v) { return (mesh.position(v) - centre).squaredNorm() <= radius * radius; });
}

}  // namespace armature::sdk
