#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <armature/sdk/error.h>
#include <armature/sdk/expansion/expansion.h>
#include <armature/sdk/selection/surface.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// What counts as like a patch.
struct PatchExpansionOptions {
  /// Candidates that are looked at: the likeliest by contexts. The other places are said to be rejected for that.
  std::size_t most = 64;
  std::vector<double> scales = {1};  ///< sizes that are looked for, against the reference; each between 1/8 and 8
  bool mirrored = true;              ///< whether mirror images count
};

/// How long the steps of an expansion took, in milliseconds.
struct PatchExpansionTimes {
  double map_ms = 0;                ///< similarity maps
  double learn_ms = 0;              ///< what is asked about the reference once
  double matches_ms = 0;            ///< laying the patch onto all candidates, and their extents
  double matches_processor_ms = 0;  ///< the same as processor time of the whole process, on all cores together
  std::size_t candidates = 0;       ///< how many were looked at
};

/// Finds the regions of a surface that are like a patch (thesis, section 5.4.3): maxima of the similarity map, laid
/// onto the reference by its relief around its mean normal, its second moments and iterated closest points; a face
/// belongs to a match where it comes to lie on a face of the reference. A match is connected. Its score is the mean of
/// the similarity of contexts and of how well the surfaces lie on one another; its reason says where it would lie
/// nearly as well turned otherwise or mirrored. Uses all cores; the same on any number of them. Refused
/// where `patch_ball()` refuses.
[[nodiscard]] Expected<Expansion> expand_patch(const Surface& surface, std::span<const FaceId> patch,
                                               const PatchExpansionOptions& options = {}, const Task& task = {},
                                               PatchExpansionTimes* times = nullptr);
/// The same with a patch of another surface.
[[nodiscard]] Expected<Expansion> expand_patch(const Surface& surface, const Surface& of_patch,
                                               std::span<const FaceId> patch, const PatchExpansionOptions& options = {},
                                               const Task& task = {}, PatchExpansionTimes* times = nullptr);

}  // namespace armature::sdk
