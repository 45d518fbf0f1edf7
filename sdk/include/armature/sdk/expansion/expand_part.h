#pragma once

#include <cstddef>
#include <span>

#include <armature/sdk/error.h>
#include <armature/sdk/expansion/expansion.h>
#include <armature/sdk/mesh/ids.h>
#include <armature/sdk/selection/part_model.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// Which parts are looked for.
struct ExpandPartOptions {
  double largest_scale = 3;        ///< how many times as wide as the reference a match may be, or as narrow
  std::size_t most_matches = 128;  ///< the least alike are left out beyond
};

/// Finds the parts of a surface that are like one (thesis, section 5.4.2 and algorithm 2): isolines of the conformal
/// factor are virtual strokes, each is solved for its best cut, and the parts are ranked by how alike the factor, the
/// girth and the distance from the cut spread over them (chi-square).
///
/// The thesis takes the isolines of the reference's own value, which cut longer parts elsewhere. Here the isolines that
/// follow one another from the tip of every part to its root are compared with the reference's by their girth, and the
/// one is taken around which it runs alike; so length, size and bending do not matter for where a match ends. What fits
/// the reference closely is cut where the reference is.
///
/// `part` ascends, as PartCut gives it. A part that does not protrude has no matches. Uses all cores; the same on any
/// number of them.
[[nodiscard]] Expected<Expansion> expand_part(const PartModel& model, std::span<const FaceId> part,
                                              const ExpandPartOptions& options = {}, const Task& task = {});
/// The same for a part of another surface, `of`: matches lie on `model`. `options.largest_scale` is between the two.
[[nodiscard]] Expected<Expansion> expand_part(const PartModel& model, const PartModel& of, std::span<const FaceId> part,
                                              const ExpandPartOptions& options = {}, const Task& task = {});

}  // namespace armature::sdk
