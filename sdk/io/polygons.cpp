#include "sdk/io/polygons.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <armature/sdk/mesh/triangulate.h>

#include "sdk/io/text_scanner.h"
#include "sdk/mesh/lengths.h"

namespace armature::sdk {

Expected<Mesh> triangulated(Polygons polygons, std::string_view name, const Task& task) {
  std::size_t triangles = 0;
  for (const std::uint32_t count : polygons.counts) triangles += count - 2;
  if (triangles == 0) return fail(std::string(name) + ": expected at least one face; it has none");
  if (triangles > kMostElements) return fail(std::string(name) + ": expected fewer than 2^32 - 1 triangles");

  Mesh mesh;
  mesh.positions = std::move(polygons.positions);
  if (polygons.vertex_colours.size() == mesh.positions.size()) mesh.vertex_colours = std::move(polygons.vertex_colours);
  mesh.triangles.reserve(triangles);
  const bool coloured = polygons.polygon_colours.size() == polygons.counts.size();
  if (coloured) mesh.face_colours.reserve(triangles);
  std::span<const VertexId> corners = polygons.corners;
  ReadingPace pace(task);
  for (std::size_t i = 0; i < polygons.counts.size(); ++i) {
    if (pace.stopped(i, polygons.counts.size())) return cancelled();
    const std::size_t count = polygons.counts[i];
    triangulate_polygon(corners.first(count), mesh.positions, mesh.triangles);
    corners = corners.subspan(count);
    if (coloured) mesh.face_colours.resize(mesh.triangles.size(), polygons.polygon_colours[i]);
  }
  return mesh;
}

Expected<MeshOrPoints> mesh_or_points(Polygons polygons, std::string_view name, const Task& task) {
  const std::size_t count = polygons.positions.size();
  if (!polygons.counts.empty() || count == 0) return triangulated(std::move(polygons), name, task);
  PointSet points;
  points.positions = std::move(polygons.positions);
  points.normals = std::move(polygons.normals);
  points.areas = std::move(polygons.areas);
  if (polygons.vertex_colours.size() == count) points.colours = std::move(polygons.vertex_colours);
  return points;
}

std::string_view made_unit(Eigen::Vector3d& normal) noexcept {
  if (!normal.allFinite()) return "a normal of finite numbers";
  if (normal.isZero(0)) return "a normal that points outward; estimate it anew or leave the point out";
  normal = direction_of(normal);
  return {};
}

Colour colour_of_fractions(double red, double green, double blue) noexcept {
  const auto byte = [](double fraction) {
    return fraction > 0 ? static_cast<std::uint8_t>(std::lround(255 * std::min(fraction, 1.0))) : std::uint8_t{0};
  };
  return {byte(red), byte(green), byte(blue)};
}

}  // namespace armature::sdk
