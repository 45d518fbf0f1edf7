#pragma once

#include <cstddef>

#include <armature/sdk/error.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/task.h>

namespace armature::tools {

/// How long the steps of selecting a part and its likes take, in milliseconds (thesis, table 5.1).
struct PartTimes {
  double load_ms = 0;        ///< the surface
  double precompute_ms = 0;  ///< the part model (PT)
  double step_ms = 0;        ///< a point of the stroke and the part that it makes, in the median (ST)
  std::size_t strokes = 0;   ///< virtual strokes: candidates that were solved (PS)
  double expand_ms = 0;      ///< all of these (ET)
};

/// The fastest of some rounds. The stroke lies across one side of what protrudes most, a tenth of the diagonal below
/// its tip. A mesh without area is refused.
[[nodiscard]] sdk::Expected<PartTimes> part_times(const sdk::Mesh& mesh, int rounds, const sdk::Task& task);

/// A ball with horns of one shape, spread evenly: an icosphere of 10 * 4^rounds + 2 vertices.
[[nodiscard]] sdk::Mesh horned_ball(int rounds, int horns);

}  // namespace armature::tools
