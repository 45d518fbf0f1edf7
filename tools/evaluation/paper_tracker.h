#pragma once

#include <memory>
#include <span>
#include <vector>

#include "tracker/body/skeleton.h"
#include "tracker/forest/part_classifier.h"
#include "tracker/joints/vote_cloud.h"

namespace armature::tools {

/// The forest as the paper has it: its first three trees.
[[nodiscard]] Forest paper_forest_of(const Forest& forest);

/// Just the paper (Shotton et al. 2011, sections 3.3 and 4): each pixel votes with its area for its most likely part;
/// mean shift finds the strongest mode of the parts that lie on a joint, which is pushed back from the surface by
/// constants of that joint. No memory of other frames, no model of the body. To compare with; same shape as
/// SkeletonTracker.
class PaperTracker {
 public:
  PaperTracker(std::shared_ptr<const Forest> forest, int stride);

  /// Takes memory for images of this size.
  void reset(const Intrinsics& intrinsics) { classifier_.reset(intrinsics); }
  /// `mask` [height][width]: 1 where the person is. A joint without a pixel of its parts is lost.
  const Skeleton& track(DepthView frame, std::span<const std::uint8_t> mask);

 private:
  void find(JointId joint, const PartVotes& votes);

  PartClassifier classifier_;
  VoteCloud cloud_;
  std::vector<PartLabel> labels_;  // of the votes' pixels
  Skeleton skeleton_;
};

}  // namespace armature::tools
