#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include <Eigen/Geometry>
#include <armature/sdk/descriptors/point_set.h>
#include <armature/sdk/mesh/measures.h>

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
  for (std::size_t i = 0; i < count; ++i) {
    const std::string at = "point " + std::to_string(i) + ": ";
    if (!points.positions[i].allFinite()) return fail(at + "expected a finite position");
    if (!points.normals[i].allFinite())
      return fail(at + "expected a finite normal; a normal that is not known is 0 0 0");
    if (!points.areas.empty() && !(points.areas[i] >= 0 && std::isfinite(points.areas[i])))
      return fail(at + "expected an area that is finite and not negative");
  }
  return {};
}

double spacing(const PointSet& points) {
  // The nearest neighbour of every 64th point, and no fewer than 1000, found along the longest axis.
  const auto& positions = points.positions;
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : positions) box.extend(p);
  if (positions.size() < 2) return 0;
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, {}, [&](std::uint32_t i) { return std::pair(positions[i][axis], i); });
  const std::size_t step = std::clamp<std::size_t>(positions.size() / 1000, 1, 64);
  std::vector<double> nearest;
  for (std::size_t i = 0; i < order.size(); i += step) {
    const Eigen::Vector3d& p = positions[order[i]];
    double best = std::numeric_limits<double>::infinity();
    // True once everything further on lies too far away.
    const auto look = [&](std::size_t k) {
      const Eigen::Vector3d off = positions[order[k]] - p;
      const double d2 = off.squaredNorm();
      if (d2 > 0) best = std::min(best, d2);
      return off[axis] * off[axis] > best;
    };
    for (std::size_t k = i; k-- > 0 && !look(k);) {
    }
    for (std::size_t k = i + 1; k < order.size() && !look(k); ++k) {
    }
    if (std::isfinite(best)) nearest.push_back(std::sqrt(best));
  }
  if (nearest.empty()) return 0;
  const auto middle = nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2);
  std::ranges::nth_element(nearest, middle);
  return *middle;
}

}  // namespace armature::sdk
