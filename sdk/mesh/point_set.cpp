#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <armature/sdk/mesh/measures.h>
#include <armature/sdk/mesh/point_set.h>

#include "sdk/mesh/nearest_point.h"

namespace armature::sdk {

PointSet point_set_of(const Mesh& mesh) {
  return {.positions = mesh.positions, .normals = vertex_normals(mesh), .areas = barycentric_areas(mesh)};
}

Expected<void> validate(const PointSet& points) {
  const std::size_t count = points.positions.size();
  if (points.normals.size() != count)
    return fail("normals: expected one a point, " + std::to_string(count) + ", found " +
                std::to_string(points.normals.size()));
  if (!points.areas.empty() && points.areas.size() != count)
    return fail("areas: expected one a point, " + std::to_string(count) + ", or none; found " +
                std::to_string(points.areas.size()));
  if (!points.colours.empty() && points.colours.size() != count)
    return fail("colours: expected one a point, " + std::to_string(count) + ", or none; found " +
                std::to_string(points.colours.size()));
  for (std::size_t i = 0; i < count; ++i) {
    const auto wrong = [i](const char* expected) {
      return fail("point " + std::to_string(i) + ": expected " + expected);
    };
    if (!points.positions[i].allFinite()) return wrong("a finite position");
    if (!points.normals[i].allFinite()) return wrong("a finite normal; a normal that is not known is 0 0 0");
    if (!points.areas.empty() && !(points.areas[i] >= 0 && std::isfinite(points.areas[i])))
      return wrong("an area that is finite and not negative");
  }
  return {};
}

double spacing(const PointSet& points) {
  // Places once each, so that the closest is the closest other place.
  std::vector<Eigen::Vector3d> places = points.positions;
  const auto less = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::ranges::lexicographical_compare(a, b);
  };
  std::ranges::sort(places, less);
  places.erase(std::unique(places.begin(), places.end()), places.end());
  if (places.size() < 2) return 0;
  // Of every 64th place, and no fewer than 1000.
  const std::size_t step = std::clamp<std::size_t>(places.size() / 1000, 1, 64);
  const NearestPoint tree(places);
  std::vector<double> nearest;
  for (std::size_t i = 0; i < places.size(); i += step)
    nearest.push_back(std::sqrt(
        tree.find(places[i], std::numeric_limits<double>::infinity(), static_cast<std::uint32_t>(i)).distance2));
  const auto middle = nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2);
  std::ranges::nth_element(nearest, middle);
  return *middle;
}

}  // namespace armature::sdk
