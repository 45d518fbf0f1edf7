#include "sdk/selection/surface_walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_set>

#include <Eigen/Geometry>

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

/// Where a plane leaves a face.
struct Exit {
  std::size_t side = 0;
  double t = 0;  ///< from the side's first corner to its second
  Vector3d point;
};

/// Where the plane of unit normal `across` at `from` leaves a face, other than by the side it came in; the exit that
/// lies farthest along `ahead`.
std::optional<Exit> leave(const Mesh& mesh, FaceId face, const Vector3d& from, const Vector3d& across,
                          const Vector3d& ahead, std::optional<std::size_t> came_in) {
  std::array<double, 3> height{};
  for (std::size_t k = 0; k < 3; ++k) {
    height[k] = (mesh.corner(face, k) - from).dot(across);
    // A corner in the plane counts as above it, so that the way leads past it on one side.
    if (height[k] == 0) height[k] = std::numeric_limits<double>::min();
  }
  std::optional<Exit> best;
  for (std::size_t side = 0; side < 3; ++side) {
    const std::size_t next = (side + 1) % 3;
    if (came_in == side || (height[side] > 0) == (height[next] > 0)) continue;
    const double t = height[side] / (height[side] - height[next]);
    const Vector3d point = mesh.corner(face, side) + t * (mesh.corner(face, next) - mesh.corner(face, side));
    if (!best || point.dot(ahead) > best->point.dot(ahead)) best = Exit{side, t, point};
  }
  return best;
}

/// The weights of a face's corners at a point on a segment that starts on a side of it.
SurfacePoint on(const Mesh& mesh, FaceId face, const Vector3d& point) {
  const Vector3d& a = mesh.corner(face, 0);
  const Vector3d ab = mesh.corner(face, 1) - a;
  const Vector3d ac = mesh.corner(face, 2) - a;
  const Vector3d normal = ab.cross(ac);
  const double b = (point - a).cross(ac).dot(normal) / normal.squaredNorm();
  const double c = ab.cross(point - a).dot(normal) / normal.squaredNorm();
  Vector3d weights(1 - b - c, b, c);
  weights = weights.allFinite() ? Vector3d(weights.cwiseMax(0)) : Vector3d(Vector3d::Ones());
  return {.face = face, .point = point, .barycentric = weights / weights.sum(), .distance = 0};
}

}  // namespace

SurfacePoint walk(const Mesh& mesh, const Adjacency& adjacency, const SurfacePoint& start, const Vector3d& direction,
                  const Vector3d& up, double distance) {
  const Vector3d across = up.cross(direction).stableNormalized();
  SurfacePoint at = start;
  if (across.isZero()) return at;
  std::optional<std::size_t> came_in;
  std::unordered_set<FaceId> seen;
  while (seen.insert(at.face).second) {
    const auto exit = leave(mesh, at.face, start.point, across, direction, came_in);
    if (!exit) break;
    if ((exit->point - start.point).norm() >= distance) {
      // Between where it came in, which is nearer, and where it leaves.
      const Vector3d step = exit->point - at.point;
      const Vector3d so_far = at.point - start.point;
      const double a = step.squaredNorm();
      const double b = so_far.dot(step);
      const double c = so_far.squaredNorm() - distance * distance;
      const double t = a > 0 ? (-b + std::sqrt(std::max(0.0, b * b - a * c))) / a : 0;
      return on(mesh, at.face, at.point + std::clamp(t, 0.0, 1.0) * step);
    }
    at = on(mesh, at.face, exit->point);

    const EdgeId edge = adjacency.edges(at.face)[exit->side];
    if (!edge.valid()) break;
    FaceId next;
    std::size_t next_side = 0;
    double best = 0;
    for (const FaceId face : adjacency.faces(edge)) {
      if (face == at.face) continue;
      const auto& edges = adjacency.edges(face);
      const auto side = static_cast<std::size_t>(std::find(edges.begin(), edges.end(), edge) - edges.begin());
      const Vector3d inwards = (mesh.corner(face, (side + 2) % 3) - at.point).stableNormalized();
      if (next.valid() && inwards.dot(direction) <= best) continue;
      next = face;
      next_side = side;
      best = inwards.dot(direction);
    }
    if (!next.valid()) break;
    at = on(mesh, next, exit->point);
    came_in = next_side;
  }
  return at;
}

VertexId closest_corner(const Mesh& mesh, const SurfacePoint& point) {
  const Triangle& corners = mesh.triangle(point.face);
  return *std::min_element(corners.begin(), corners.end(), [&](VertexId a, VertexId b) {
    return (mesh.position(a) - point.point).squaredNorm() < (mesh.position(b) - point.point).squaredNorm();
  });
}

}  // namespace armature::sdk
