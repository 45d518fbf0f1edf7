#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include <armature/sdk/mesh/measures.h>
#include <armature/sdk/selection/boundary.h>

#include "sdk/selection/flood.h"
#include "sdk/selection/min_cut.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

constexpr double kFar = std::numeric_limits<double>::infinity();

/// What one cut through the edges of a mesh costs.
class CutPrice {
 public:
  explicit CutPrice(const Surface& surface) : surface_(surface), normals_(face_normals(surface.mesh)) {
    double lengths = 0;
    double bends = 0;
    double sides = 0;
    for (std::size_t e = 0; e < surface.adjacency.edge_count(); ++e) {
      const auto faces = surface.adjacency.faces(EdgeId(e));
      if (faces.size() != 2) continue;
      lengths += length(EdgeId(e));
      bends += bend(faces[0], faces[1]);
      ++sides;
    }
    mean_length_ = lengths > 0 ? lengths / sides : 1;
    mean_bend_ = bends > 0 ? bends / sides : 1;
  }

  [[nodiscard]] std::int64_t operator()(EdgeId edge, FaceId a, FaceId b) const {
    constexpr double kUnit = 1e6;
    const double price = length(edge) / mean_length_ / (1 + bend(a, b) / mean_bend_);
    return 1 + static_cast<std::int64_t>(kUnit * std::min(price, 1e6));
  }

 private:
  [[nodiscard]] double length(EdgeId edge) const {
    const auto& [a, b] = surface_.adjacency.edge(edge);
    return (surface_.mesh.position(a) - surface_.mesh.position(b)).norm();
  }
  /// 1 - cos of the angle between the faces, less over a ridge.
  [[nodiscard]] double bend(FaceId a, FaceId b) const {
    constexpr double kRidge = 0.2;
    const Vector3d& n = normals_[a.index()];
    const bool ridge = n.dot(middle(surface_.mesh, b) - middle(surface_.mesh, a)) < 0;
    return (ridge ? kRidge : 1) * std::max(0.0, 1 - n.dot(normals_[b.index()]));
  }

  const Surface& surface_;
  std::vector<Vector3d> normals_;
  double mean_length_ = 1, mean_bend_ = 1;
};

/// By FaceId.
std::vector<bool> membership(const Mesh& mesh, std::span<const FaceId> region) {
  std::vector<bool> inside(mesh.triangles.size());
  for (const FaceId face : region) inside[face.index()] = true;
  return inside;
}

std::vector<FaceId> faces_of(const std::vector<bool>& inside) {
  std::vector<FaceId> faces;
  for (std::size_t f = 0; f < inside.size(); ++f)
    if (inside[f]) faces.emplace_back(f);
  return faces;
}

using Start = std::pair<double, FaceId>;  // a distance that is known, and where

/// How far the middles of faces lie from some, over faces that share a corner (Dijkstra 1959), up to a limit and within
/// what is allowed. By FaceId; kFar elsewhere. Of no use where the task was stopped.
std::vector<double> distances(const Surface& surface, const std::vector<Start>& starts, double limit,
                              const std::function<bool(FaceId)>& allowed, const Task& task) {
  constexpr std::size_t kNowAndThen = 1U << 12U;
  std::size_t looked_at = 0;
  const Mesh& mesh = surface.mesh;
  std::vector<double> distance(mesh.triangles.size(), kFar);
  std::priority_queue<Start, std::vector<Start>, std::greater<>> open;
  const auto reach = [&](FaceId face, double at) {
    if (!(at <= limit) || at >= distance[face.index()] || !allowed(face)) return;
    distance[face.index()] = at;
    open.push({at, face});
  };
  for (const auto& [at, face] : starts) reach(face, at);
  while (!open.empty() && (++looked_at % kNowAndThen != 0 || !task.stopped())) {
    const auto [at, face] = open.top();
    open.pop();
    if (at > distance[face.index()]) continue;
    const Vector3d here = middle(mesh, face);
    for (const VertexId corner : mesh.triangle(face))
      for (const FaceId next : surface.adjacency.faces(corner)) reach(next, at + (middle(mesh, next) - here).norm());
  }
  return distance;
}

/// The faces on both sides of a region's boundary, with their distance from it.
std::vector<Start> along_boundary(const Surface& surface, const std::vector<bool>& inside) {
  std::vector<Start> starts;
  for (std::size_t e = 0; e < surface.adjacency.edge_count(); ++e) {
    const auto faces = surface.adjacency.faces(EdgeId(e));
    const auto in = std::ranges::count_if(faces, [&](FaceId face) { return bool{inside[face.index()]}; });
    if (in == 0 || in == static_cast<std::ptrdiff_t>(faces.size())) continue;
    const auto& [a, b] = surface.adjacency.edge(EdgeId(e));
    const Vector3d at = (surface.mesh.position(a) + surface.mesh.position(b)) / 2;
    for (const FaceId face : faces) starts.emplace_back((middle(surface.mesh, face) - at).norm(), face);
  }
  return starts;
}

/// The faces that lie less than `width` away from where a boundary runs, by the distance of each. Of what lies within
/// the band as a whole, a piece of the region or a hole in it, the half that is deepest is left out: it stays.
std::vector<FaceId> band_about(const Surface& surface, const std::vector<bool>& inside,
                               const std::vector<double>& distance, double width) {
  std::vector<bool> in_band(distance.size());
  for (std::size_t f = 0; f < distance.size(); ++f) in_band[f] = distance[f] < width;
  std::vector<bool> seen(distance.size());
  for (std::size_t f = 0; f < distance.size(); ++f) {
    if (seen[f] || !in_band[f]) continue;
    const FaceId seed(f);
    bool whole = true;
    const auto piece = flood(surface.adjacency, std::span(&seed, 1), distance.size(), [&](FaceId face) {
      const bool same_side = inside[face.index()] == inside[f];
      whole &= !same_side || distance[face.index()] < width;
      return same_side && distance[face.index()] < width;
    });
    double depth = 0;
    for (const FaceId face : piece) {
      seen[face.index()] = true;
      depth = std::max(depth, distance[face.index()]);
    }
    for (const FaceId face : piece)
      if (whole && 2 * distance[face.index()] >= depth) in_band[face.index()] = false;
  }
  return faces_of(in_band);
}

/// Cuts anew between what is inside and what is not, in a band of faces; what lies elsewhere stays. Of no use where the
/// task was stopped.
void cut_within(const Surface& surface, const std::vector<FaceId>& band, std::vector<bool>& inside, const Task& task) {
  constexpr std::size_t kElsewhere = ~std::size_t{0};
  constexpr std::size_t kSource = 0;
  constexpr std::size_t kSink = 1;
  std::vector<std::size_t> node(inside.size(), kElsewhere);
  for (std::size_t i = 0; i < band.size(); ++i) node[band[i].index()] = i + 2;
  MinCut cut(band.size() + 2);
  const CutPrice price(surface);
  for (const FaceId face : band)
    for (const EdgeId edge : surface.adjacency.edges(face)) {
      if (!edge.valid()) continue;
      for (const FaceId next : surface.adjacency.faces(edge)) {
        if (node[next.index()] == kElsewhere)
          cut.join(inside[next.index()] ? kSource : kSink, node[face.index()], price(edge, face, next));
        else if (face < next)
          cut.join(node[face.index()], node[next.index()], price(edge, face, next));
      }
    }
  const std::vector<bool> source = cut.source_side(kSource, kSink, task);
  for (const FaceId face : band) inside[face.index()] = source[node[face.index()]];
}

}  // namespace

Expected<std::vector<FaceId>> snap_boundary(const Surface& surface, std::span<const FaceId> region, double width,
                                            const Task& task) {
  std::vector<bool> inside = membership(surface.mesh, region);
  const auto distance = distances(
      surface, along_boundary(surface, inside), width, [](FaceId) { return true; }, task);
  if (!task.stopped()) cut_within(surface, band_about(surface, inside, distance, width), inside, task);
  if (task.stopped()) return cancelled();
  return faces_of(inside);
}

Expected<std::vector<FaceId>> drag_boundary(const Surface& surface, std::span<const FaceId> region,
                                            const BoundaryDrag& drag, const Task& task) {
  std::vector<bool> inside = membership(surface.mesh, region);
  const double limit = std::max(drag.reach, 3 * (drag.to.point - drag.from.point).norm());
  const auto from_hand = distances(
      surface, {{0, drag.from.face}}, limit, [](FaceId) { return true; }, task);
  const auto near = [&](FaceId face) { return from_hand[face.index()] < kFar; };
  const auto from_boundary = distances(surface, along_boundary(surface, inside), kFar, near, task);
  if (task.stopped()) return cancelled();
  const double way = from_hand[drag.to.face.index()];
  if (way == kFar || from_boundary[drag.to.face.index()] == kFar) return faces_of(inside);

  // Where the boundary is to run: so far from where it runs, outwards positive.
  const auto outwards = [&](FaceId face) { return (inside[face.index()] ? -1 : 1) * from_boundary[face.index()]; };
  const double moved = outwards(drag.to.face);
  const double reach = std::clamp(2 * way, drag.reach, limit);
  const auto wanted = [&](FaceId face) {
    const double t = reach > way ? std::clamp((from_hand[face.index()] - way) / (reach - way), 0.0, 1.0) : 0;
    return moved * std::pow(1 - t * t, 2);
  };
  std::vector<bool> dragged = inside;
  std::vector<double> from_wanted(inside.size(), kFar);
  for (std::size_t f = 0; f < inside.size(); ++f) {
    const FaceId face(f);
    if (!near(face) || from_boundary[f] == kFar || from_hand[f] > reach) continue;
    const double beyond = outwards(face) - wanted(face);
    dragged[f] = beyond < 0;
    from_wanted[f] = std::abs(beyond);
  }
  if (drag.snap > 0) cut_within(surface, band_about(surface, dragged, from_wanted, drag.snap), dragged, task);
  if (task.stopped()) return cancelled();
  return faces_of(dragged);
}

}  // namespace armature::sdk
