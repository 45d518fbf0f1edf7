#include "sdk/editing/edit_region.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace armature::sdk {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// By vertex: the way along edges from the boundary that the region has within the surface; infinite without one. The
/// surface's own rim is none: there is nothing beyond.
std::vector<double> ways_from_boundary(const Surface& surface, const EditRegion& region,
                                       std::span<const FaceId> faces) {
  std::vector<bool> within(surface.mesh.triangles.size(), false);
  for (const FaceId face : faces) within[face.index()] = true;
  std::vector<double> way(region.mesh.positions.size(), kFar);
  using Step = std::pair<double, std::uint32_t>;
  std::priority_queue<Step, std::vector<Step>, std::greater<>> next;
  for (std::uint32_t v = 0; v < way.size(); ++v)
    if (std::ranges::any_of(surface.adjacency.faces(region.vertex_of[v]),
                            [&](FaceId face) { return !within[face.index()]; })) {
      way[v] = 0;
      next.emplace(0, v);
    }
  if (next.empty()) return way;
  const Adjacency adjacency(region.mesh);
  while (!next.empty()) {
    const auto [length, v] = next.top();
    next.pop();
    if (length > way[v]) continue;
    for (const VertexId u : adjacency.neighbours(VertexId(v))) {
      const double there = length + (region.mesh.position(u) - region.mesh.positions[v]).norm();
      if (there >= way[u.index()]) continue;
      way[u.index()] = there;
      next.emplace(there, static_cast<std::uint32_t>(u.index()));
    }
  }
  return way;
}

}  // namespace

Mesh EditRegion::laid_on() const {
  Mesh there = mesh;
  for (Eigen::Vector3d& p : there.positions) p = to_reference(p);
  return there;
}

Expected<EditRegion> edit_region(const Surface& surface, std::span<const FaceId> faces,
                                 const Eigen::Matrix4d& reference_from_region, double blend, const std::string& name) {
  if (faces.empty()) return fail(name + ": expected a face or more, found none");
  EditRegion region;
  region.linear = reference_from_region.topLeftCorner<3, 3>();
  region.offset = reference_from_region.topRightCorner<3, 1>();
  const double volume = std::abs(region.linear.determinant());
  if (!reference_from_region.allFinite() || !(volume > 0))
    return fail(name + ": expected a motion onto the reference that can be undone");
  region.scale = std::cbrt(volume);
  std::vector<std::uint32_t> place(surface.mesh.positions.size(), 0xFFFF'FFFFU);
  for (const FaceId face : faces) {
    if (!face.valid() || face.index() >= surface.mesh.triangles.size())
      return fail(name + ": expected faces below " + std::to_string(surface.mesh.triangles.size()));
    Triangle triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId v = surface.mesh.triangle(face)[k];
      if (place[v.index()] == 0xFFFF'FFFFU) {
        place[v.index()] = static_cast<std::uint32_t>(region.vertex_of.size());
        region.vertex_of.push_back(v);
        region.mesh.positions.push_back(surface.mesh.position(v));
        if (!surface.mesh.vertex_colours.empty())
          region.mesh.vertex_colours.push_back(surface.mesh.vertex_colours[v.index()]);
      }
      triangle[k] = VertexId(place[v.index()]);
    }
    region.mesh.triangles.push_back(triangle);
  }
  const std::vector<double> way = ways_from_boundary(surface, region, faces);
  double longest = 0;
  for (const double w : way)
    if (std::isfinite(w)) longest = std::max(longest, w);
  for (const double w : way) {
    const double x = longest > 0 && blend > 0 ? std::min(1.0, w / (blend * longest)) : (w > 0 ? 1.0 : 0.0);
    region.inside.push_back(x * x * (3 - 2 * x));
  }
  return region;
}

}  // namespace armature::sdk
