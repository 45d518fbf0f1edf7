#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/error.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/selection/part_model.h>
#include <armature/sdk/task.h>

namespace armature::tools {

/// How long the steps of selecting a part and its likes take, in milliseconds (thesis, table 5.1).
struct PartTimes {
  double load_ms = 0;        ///< the surface
  double precompute_ms = 0;  ///< the part model (PT)
  double usable_ms = 0;      ///< from the mesh in memory to the part that the first point of a stroke makes
  double step_ms = 0;        ///< a point of the stroke and the part that it makes, in the median (ST)
  std::size_t strokes = 0;   ///< virtual strokes: candidates that were solved (PS)
  double expand_ms = 0;      ///< all of these (ET)
};

/// Where a part ends that somebody might select.
struct PartTip {
  std::optional<Eigen::Vector3d> at = std::nullopt;  ///< about where; otherwise what protrudes most
  double below = 0.1;                                ///< how far below the tip the stroke lies, of the diagonal
};

/// Points across one side of what protrudes there, along the isoline of the conformal factor: as a hand would draw.
[[nodiscard]] std::vector<sdk::SurfacePoint> stroke_below(const sdk::PartModel& model, const PartTip& tip);

/// The fastest of some rounds, for such a stroke. A mesh without area is refused.
[[nodiscard]] sdk::Expected<PartTimes> part_times(const sdk::Mesh& mesh, const PartTip& tip, int rounds,
                                                  const sdk::Task& task);

/// A ball with horns of one shape, spread evenly: an icosphere of 10 * 4^rounds + 2 vertices.
[[nodiscard]] sdk::Mesh horned_ball(int rounds, int horns);

}  // namespace armature::tools
