#pragma once

#include <span>
#include <vector>

#include <armature/sdk/error.h>
#include <armature/sdk/mesh/ids.h>
#include <armature/sdk/selection/surface.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// A region whose boundary runs where the surface is best cut, within `width` of where it runs: the cheapest cut (the
/// least cut of the faces' graph) whose edges cost their length, less where the surface bends, least in a valley (Katz
/// and Tal 2003). Faces ascend. A region without a boundary stays as it is. Takes time about linear in the faces within
/// `width` of the boundary, and in the mesh. Fails as cancelled alone.
[[nodiscard]] Expected<std::vector<FaceId>> snap_boundary(const Surface& surface, std::span<const FaceId> region,
                                                          double width, const Task& task = {});

/// How a boundary is dragged; lengths in the mesh's unit.
struct BoundaryDrag {
  SurfacePoint from;  ///< where it is taken hold of, on the boundary or near it
  SurfacePoint to;    ///< where it is to pass
  double reach = 0;   ///< how far from `from` the boundary follows, less and less; at least twice the way that it goes
  double snap = 0;    ///< how far from there it may run if it is better cut, as by `snap_boundary()`; 0: exactly there
};

/// A region whose boundary is dragged to a point: outwards, what lies on the way belongs to it, inwards no longer. All
/// distances are along the surface. Faces ascend; what lies out of reach stays, and so does all where `to` cannot be
/// reached. To follow a hand, drag the same region anew at every move. Fails as cancelled alone.
[[nodiscard]] Expected<std::vector<FaceId>> drag_boundary(const Surface& surface, std::span<const FaceId> region,
                                                          const BoundaryDrag& drag, const Task& task = {});

}  // namespace armature::sdk
