#pragma once

#include <vector>

#include "tracker/body/body_surface.h"

namespace armature {

/// A wheelchair on the floor whose seat's centre is over the origin, facing forward, in the axes of a body (pose.h):
/// seat, backrest, armrests, two large and two small wheels, footrests `thigh` before the seat's centre. Replaces what
/// is in `out`.
void wheelchair(double seat_height, double thigh, std::vector<SurfaceEdge>& out);

}  // namespace armature
