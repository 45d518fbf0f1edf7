#pragma once

#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/distance/mesh_tree.h>
#include <armature/sdk/selection/surface.h>

namespace armature::sdk {

/// A piece of an isoline of a field on a surface: a point on every edge that it crosses, in order.
struct Isoline {
  std::vector<SurfacePoint> points = {};
  bool closed = false;  ///< the last is followed by the first
};

/// Follows the isoline of a field by VertexId through a face both ways, `reach` far each, until it closes or meets a
/// boundary. Empty where the isoline does not cross the face.
[[nodiscard]] Isoline trace_isoline(const Surface& surface, std::span<const double> field, FaceId through,
                                    double isovalue, double reach = std::numeric_limits<double>::infinity());

/// Points along an isoline, `spacing` apart: at most `most` of them, then farther apart.
[[nodiscard]] std::vector<SurfacePoint> spread_along(const Isoline& isoline, double spacing, std::size_t most);

}  // namespace armature::sdk
