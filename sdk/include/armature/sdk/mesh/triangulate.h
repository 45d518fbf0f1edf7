#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <armature/sdk/mesh/mesh.h>

namespace armature::sdk {

/// Appends the triangles of one polygon, corners.size() - 2 of them, in its orientation. A convex polygon becomes a fan
/// around its first corner, any other is cut by ear clipping in its plane (that of Newell's normal). Where a polygon
/// has no plane or crosses itself, some triangles are degenerate or overlap; so are those of a concave polygon of
/// thousands of corners that is made to take long. At least three corners; each names one of `positions`.
void triangulate_polygon(std::span<const VertexId> corners, std::span<const Eigen::Vector3d> positions,
                         std::vector<Triangle>& out);

}  // namespace armature::sdk
