#pragma once

#include <armature/sdk/error.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/mesh/point_set.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// Points with normals, and what joins them for want of faces.
struct PointSurface {
  PointSet points;  ///< normals of unit length or zero; each point's area
  /// The same positions. Triangles of points that lie beside one another, turned as their normals are: most of the
  /// surface once, some of it twice, here and there none. Edges on none of them as triangles that repeat a corner.
  Mesh mesh;
};

/// Joins every point to those whose cells touch its own: its neighbours, laid out in its tangent plane at their true
/// distances, cut it out of a disc by bisectors (a Voronoi cell; after the localised triangulation of Gopi, Krishnan,
/// Silva 2000). Neighbours are the 24 closest that face no other side (normals more than 120 degrees apart are of the
/// other side of a thin sheet, or of what is behind a gap); the disc reaches to the sixth. Points are joined if either
/// finds the other, and triangles are those that follow one another about one. The area of the cell is the point's
/// unless `points` has areas. Parts that touch back to back are joined by the shortest edge through the solid.
/// Points at one place are joined and share a cell; points without a normal are joined to nothing and have no area.
/// Time n log n; the same on any number of threads. Refused: what `validate()` refuses, no points, no normals,
/// a diagonal whose square is no number to reckon with, and areas that are together 0 or 1e12 times off its square.
[[nodiscard]] Expected<PointSurface> surface_of(PointSet points, const Task& task = {});

}  // namespace armature::sdk
