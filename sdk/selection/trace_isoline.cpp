#include "sdk/selection/trace_isoline.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_set>

namespace armature::sdk {
namespace {

/// Walks from face to face along one direction of an isoline.
class Tracer {
 public:
  Tracer(const Surface& surface, std::span<const double> field, double isovalue)
      : surface_(surface), field_(field), isovalue_(isovalue) {}

  /// The sides of a face that the isoline crosses: two or none.
  [[nodiscard]] std::vector<std::size_t> crossed(FaceId face) const {
    std::vector<std::size_t> sides;
    for (std::size_t k = 0; k < 3; ++k)
      if (above(face, k) != above(face, (k + 1) % 3)) sides.push_back(k);
    return sides;
  }

  /// The points from a face out of one of its sides, in order. True if it came back to the face.
  bool follow(FaceId face, std::size_t side, double reach, std::vector<SurfacePoint>& out) {
    const FaceId first = face;
    std::unordered_set<FaceId> seen = {face};
    while (true) {
      out.push_back(point(face, side));
      if (out.size() > 1) reach -= (out.back().point - out[out.size() - 2].point).norm();
      if (reach < 0) return false;
      const EdgeId edge = surface_.adjacency.edges(face)[side];
      FaceId next;
      for (const FaceId other : surface_.adjacency.faces(edge))
        if (other != face && (other == first || !seen.contains(other))) {
          next = other;
          break;
        }
      if (!next.valid()) return false;
      if (next == first) return true;
      seen.insert(next);
      const auto& edges = surface_.adjacency.edges(next);
      const auto sides = crossed(next);
      const auto leaves = std::find_if(sides.begin(), sides.end(), [&](std::size_t k) { return edges[k] != edge; });
      if (leaves == sides.end()) return false;
      face = next;
      side = *leaves;
    }
  }

 private:
  [[nodiscard]] double value(FaceId face, std::size_t k) const {
    return field_[surface_.mesh.triangle(face)[k].index()];
  }
  [[nodiscard]] bool above(FaceId face, std::size_t k) const { return value(face, k) > isovalue_; }
  [[nodiscard]] SurfacePoint point(FaceId face, std::size_t side) const {
    const std::size_t next = (side + 1) % 3;
    const double t = (isovalue_ - value(face, side)) / (value(face, next) - value(face, side));
    SurfacePoint result{.face = face, .distance = 0};
    result.barycentric[static_cast<Eigen::Index>(side)] = 1 - t;
    result.barycentric[static_cast<Eigen::Index>(next)] = t;
    result.point = (1 - t) * surface_.mesh.corner(face, side) + t * surface_.mesh.corner(face, next);
    return result;
  }

  const Surface& surface_;
  std::span<const double> field_;
  double isovalue_;
};

}  // namespace

Isoline trace_isoline(const Surface& surface, std::span<const double> field, FaceId through, double isovalue,
                      double reach) {
  Tracer tracer(surface, field, isovalue);
  const auto sides = tracer.crossed(through);
  if (sides.size() != 2) return {};
  Isoline result;
  result.closed = tracer.follow(through, sides[0], reach, result.points);
  if (result.closed) return result;
  std::vector<SurfacePoint> back;
  tracer.follow(through, sides[1], reach, back);
  std::reverse(back.begin(), back.end());
  result.points.insert(result.points.begin(), back.begin(), back.end());
  return result;
}

std::vector<SurfacePoint> spread_along(const Isoline& isoline, double spacing, std::size_t most) {
  const auto& points = isoline.points;
  if (points.size() < 2) return points;
  double length = 0;
  for (std::size_t i = 1; i < points.size(); ++i) length += (points[i].point - points[i - 1].point).norm();
  spacing = std::max(spacing, length / static_cast<double>(most));
  std::vector<SurfacePoint> result = {points.front()};
  double way = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    way += (points[i].point - points[i - 1].point).norm();
    if (way < spacing) continue;
    result.push_back(points[i]);
    way = 0;
  }
  return result;
}

}  // namespace armature::sdk
