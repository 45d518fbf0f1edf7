#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <span>
#include <string>
#include <tuple>
#include <utility>

#include <armature/sdk/mesh/measures.h>
#include <armature/sdk/selection/patch_brush.h>
#include <armature/sdk/selection/selection.h>

#include "sdk/mesh/nearest_point.h"
#include "sdk/selection/flood.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

constexpr double kReach = 3;           // of the radius: how far from the stroke the floods may compete
constexpr double kSmooth = 0.15;       // of the radius: what normals are means over
constexpr int kMostRounds = 20;        // of smoothing
constexpr int kStraighten = 3;         // rounds
constexpr double kRidgePrice = 0.3;    // of a bend over a ridge, against one through a valley
constexpr double kLengthPrice = 0.01;  // of a step, over the square of the radius

/// The squared distance of a point to the segment from a to b.
double squared_distance(const Vector3d& point, const Vector3d& a, const Vector3d& b) {
  const Vector3d along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0 ? std::clamp((point - a).dot(along) / length2, 0.0, 1.0) : 0;
  return (point - a - t * along).squaredNorm();
}

enum Owner : std::uint8_t { kNobody, kPatch, kBackground };

/// The cheapest way found to a face.
struct Arrival {
  double cost;
  FaceId face;
  std::uint8_t owner;
  friend bool operator>(const Arrival& a, const Arrival& b) {
    return std::tie(a.cost, a.owner, a.face) > std::tie(b.cost, b.owner, b.face);
  }
};

}  // namespace

PatchBrush::PatchBrush(const Surface& surface, double radius)
    : surface_(&surface),
      radius_(radius),
      marks_(surface.mesh.triangles.size(), Mark::Far),
      place_(surface.mesh.triangles.size()) {}

void PatchBrush::draw_to(const SurfacePoint& point, Brush brush) {
  const Mesh& mesh = surface_->mesh;
  const SurfacePoint from = before_.face.valid() ? before_ : point;
  before_ = point;
  const std::array seeds = {from.face, point.face};
  const auto within = [&](double reach) {
    return flood(surface_->adjacency, seeds, mesh.triangles.size(), [&, limit = reach * reach](FaceId face) {
      return face == seeds[0] || face == seeds[1] ||
             squared_distance(middle(mesh, face), from.point, point.point) <= limit;
    });
  };
  for (const FaceId face : within(kReach * radius_)) {
    if (marks_[face.index()] != Mark::Far) continue;
    marks_[face.index()] = Mark::Near;
    place_[face.index()] = static_cast<std::uint32_t>(near_.size());
    near_.push_back(face);
  }
  for (const FaceId face : within(radius_))
    marks_[face.index()] = brush == Brush::Patch ? Mark::Patch : Mark::Background;
}

std::vector<Vector3d> PatchBrush::smooth_normals() const {
  const Mesh& mesh = surface_->mesh;
  std::vector<Vector3d> normals(near_.size());
  double area = 0;
  for (std::size_t i = 0; i < near_.size(); ++i) {
    normals[i] = area_vector(mesh, near_[i]);
    area += normals[i].norm();
  }
  const std::vector<Vector3d> weighted = normals;
  // A round spreads by about the side of a face.
  const double side2 = area / static_cast<double>(near_.size());
  const double rounds = side2 > 0 ? kSmooth * kSmooth * radius_ * radius_ / side2 : 0;
  for (int round = 0; round < std::min<double>(std::lround(rounds), kMostRounds); ++round) {
    std::vector<Vector3d> next = normals;
    for (std::size_t i = 0; i < near_.size(); ++i)
      for (const EdgeId edge : surface_->adjacency.edges(near_[i])) {
        if (!edge.valid()) continue;
        for (const FaceId other : surface_->adjacency.faces(edge))
          if (other != near_[i] && marks_[other.index()] != Mark::Far) next[i] += normals[place_[other.index()]];
      }
    for (std::size_t i = 0; i < near_.size(); ++i)
      normals[i] = next[i].norm() > 0 ? Vector3d(weighted[i].norm() * next[i].normalized()) : next[i];
  }
  for (Vector3d& normal : normals)
    if (normal.norm() > 0) normal.normalize();
  return normals;
}

std::vector<FaceId> PatchBrush::faces() const {
  const Mesh& mesh = surface_->mesh;
  const std::vector<Vector3d> normals = smooth_normals();
  std::vector<std::uint8_t> owner(near_.size(), kNobody);
  std::priority_queue<Arrival, std::vector<Arrival>, std::greater<>> arrivals;
  for (std::size_t i = 0; i < near_.size(); ++i) {
    const Mark mark = marks_[near_[i].index()];
    if (mark == Mark::Patch) arrivals.push({0, near_[i], kPatch});
    if (mark == Mark::Background) arrivals.push({0, near_[i], kBackground});
  }
  const auto price = [&](FaceId from, FaceId to) {
    const Vector3d bend = normals[place_[from.index()]] - normals[place_[to.index()]];
    const Vector3d step = middle(mesh, to) - middle(mesh, from);
    const bool ridge = normals[place_[from.index()]].dot(step) < 0;
    return (ridge ? kRidgePrice : 1) * bend.squaredNorm() + kLengthPrice * step.squaredNorm() / (radius_ * radius_);
  };
  // Where the surface goes on beyond reach, the background comes in.
  for (const FaceId face : near_)
    for (const EdgeId edge : surface_->adjacency.edges(face)) {
      if (!edge.valid() || marks_[face.index()] != Mark::Near) continue;
      const auto sharing = surface_->adjacency.faces(edge);
      if (std::ranges::any_of(sharing, [&](FaceId other) { return marks_[other.index()] == Mark::Far; }))
        arrivals.push({0, face, kBackground});
    }
  while (!arrivals.empty()) {
    const Arrival here = arrivals.top();
    arrivals.pop();
    std::uint8_t& taken = owner[place_[here.face.index()]];
    if (taken != kNobody) continue;
    taken = here.owner;
    for (const EdgeId edge : surface_->adjacency.edges(here.face)) {
      if (!edge.valid()) continue;
      for (const FaceId next : surface_->adjacency.faces(edge))
        if (marks_[next.index()] != Mark::Far && owner[place_[next.index()]] == kNobody)
          arrivals.push({here.cost + price(here.face, next), next, here.owner});
    }
  }
  straighten(owner);
  return largest_piece(owner);
}

/// Faces that were not brushed go with most of those around them, a few times.
void PatchBrush::straighten(std::vector<std::uint8_t>& owner) const {
  for (int round = 0; round < kStraighten; ++round) {
    const std::vector<std::uint8_t> before = owner;
    for (std::size_t i = 0; i < near_.size(); ++i) {
      if (marks_[near_[i].index()] != Mark::Near) continue;
      int others = 0;
      int all = 0;
      for (const EdgeId edge : surface_->adjacency.edges(near_[i])) {
        if (!edge.valid()) continue;
        for (const FaceId next : surface_->adjacency.faces(edge)) {
          if (next == near_[i] || marks_[next.index()] == Mark::Far) continue;
          ++all;
          others += before[place_[next.index()]] != before[i] ? 1 : 0;
        }
      }
      if (2 * others > all) owner[i] = before[i] == kPatch ? kBackground : kPatch;
    }
  }
}

std::vector<FaceId> PatchBrush::largest_piece(const std::vector<std::uint8_t>& owner) const {
  const Mesh& mesh = surface_->mesh;
  std::vector<bool> seen(near_.size());
  std::vector<FaceId> largest;
  double most = -1;
  for (std::size_t i = 0; i < near_.size(); ++i) {
    if (seen[i] || owner[i] != kPatch) continue;
    auto piece = flood(surface_->adjacency, std::span(&near_[i], 1), mesh.triangles.size(), [&](FaceId face) {
      return marks_[face.index()] != Mark::Far && owner[place_[face.index()]] == kPatch;
    });
    double brushed = 0;
    for (const FaceId face : piece) {
      seen[place_[face.index()]] = true;
      if (marks_[face.index()] == Mark::Patch) brushed += area_vector(mesh, face).norm();
    }
    if (brushed <= most) continue;
    most = brushed;
    largest = std::move(piece);
  }
  return in_order(std::move(largest));
}

namespace {

Expected<void> checked(const PatchStrokes& drawn) {
  if (!(drawn.radius > 0) || !std::isfinite(drawn.radius))
    return fail("expected a positive radius of the brush, in the model's unit");
  if (drawn.strokes.empty()) return fail("expected at least one stroke over the patch");
  return {};
}

/// Draws a brush's strokes and then those over the background: `draw(stroke, name, kind)` fails or draws one.
template <class Draw>
Expected<void> draw_all(const PatchStrokes& drawn, Draw&& draw) {
  for (const auto& [strokes, what, kind] : {std::tuple(&drawn.strokes, "strokes", Brush::Patch),
                                            std::tuple(&drawn.background, "background", Brush::Background)})
    for (std::size_t i = 0; i < strokes->size(); ++i) {
      const std::string name = std::string(what) + "[" + std::to_string(i) + "]";
      if ((*strokes)[i].empty()) return fail(name + ": expected at least one point");
      if (Expected<void> done = draw((*strokes)[i], name, kind); !done) return done;
    }
  return {};
}

constexpr const char* kNothingLeft = "background: it covers all strokes; leave some of the patch";

}  // namespace

Expected<std::vector<FaceId>> select_patch(const Surface& surface, const PatchStrokes& drawn) {
  if (auto fine = checked(drawn); !fine) return tl::unexpected(fine.error());
  PatchBrush brush(surface, drawn.radius);
  const auto done = draw_all(drawn, [&](const auto& stroke, const std::string& name, Brush kind) -> Expected<void> {
    const auto points = project_stroke(surface, stroke, name);
    if (!points) return tl::unexpected(points.error());
    brush.lift();
    for (const SurfacePoint& point : *points) brush.draw_to(point, kind);
    return {};
  });
  if (!done) return tl::unexpected(done.error());
  auto faces = brush.faces();
  if (faces.empty()) return fail(kNothingLeft);
  return faces;
}

Expected<std::vector<VertexId>> select_patch(const PointSet& points, const PatchStrokes& drawn) {
  if (auto fine = checked(drawn); !fine) return tl::unexpected(fine.error());
  if (auto fine = validate(points); !fine) return tl::unexpected(fine.error());
  if (points.positions.empty()) return fail("expected points to select from, found none");
  const NearestPoint tree(points.positions);
  std::vector<std::uint8_t> in(points.positions.size(), 0);
  bool drawn_on = false;  // by a stroke over the patch
  const auto done = draw_all(drawn, [&](const auto& stroke, const std::string& name, Brush kind) -> Expected<void> {
    for (std::size_t k = 0; k < stroke.size(); ++k) {
      if (!stroke[k].allFinite()) return fail(name + "[" + std::to_string(k) + "]: expected finite coordinates");
      const Vector3d& facing = points.normals[tree.find(stroke[k]).point];
      for (std::size_t v = 0; v < in.size(); ++v)
        if (squared_distance(points.positions[v], stroke[k == 0 ? 0 : k - 1], stroke[k]) <=
                drawn.radius * drawn.radius &&
            points.normals[v].dot(facing) >= 0) {
          in[v] = kind == Brush::Patch ? 1 : 0;
          drawn_on = drawn_on || kind == Brush::Patch;
        }
    }
    return {};
  });
  if (!done) return tl::unexpected(done.error());
  std::vector<VertexId> patch;
  for (std::size_t v = 0; v < in.size(); ++v)
    if (in[v] != 0) patch.emplace_back(v);
  if (!drawn_on) return fail("strokes: no point lies within the radius of one; draw on the points");
  if (patch.empty()) return fail(kNothingLeft);
  return patch;
}

}  // namespace armature::sdk
