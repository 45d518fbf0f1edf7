#pragma once

#include <memory>
#include <span>

#include "tracker/forest/part_classifier.h"
#include "tracker/joints/joint_estimator.h"

namespace armature::tools {

/// The joints that motions are measured with.
inline constexpr std::array kNavigationJoints = {JointId::Head,         JointId::Neck,          JointId::Waist,
                                                 JointId::LeftShoulder, JointId::RightShoulder, JointId::LeftHip,
                                                 JointId::RightHip,     JointId::LeftKnee,      JointId::RightKnee};

/// Forest and joints without the rest of the pipeline, for people who are segmented already and at rest in the first
/// third of a second.
class SkeletonTracker {
 public:
  SkeletonTracker(std::shared_ptr<const Forest> forest, int stride)
      : classifier_(forest, {.stride = stride}), estimator_(std::move(forest)) {}

  /// Forgets the person, and takes memory for images of this size.
  void reset(const Intrinsics& intrinsics) {
    classifier_.reset(intrinsics);
    estimator_.reset();
    frames_ = 0;
  }
  /// `mask` [height][width]: 1 where the person is.
  const Skeleton& track(DepthView frame, std::span<const std::uint8_t> mask) {
    votes_ = &classifier_.classify(frame, mask, 1);
    estimator_.estimate(*votes_, skeleton_);
    estimator_.keep_build(++frames_ >= kFramesAtRest);
    return skeleton_;
  }
  /// Of the last track().
  [[nodiscard]] const PartVotes& votes() const { return *votes_; }

 private:
  static constexpr int kFramesAtRest = 10;
  PartClassifier classifier_;
  JointEstimator estimator_;
  int frames_ = 0;
  const PartVotes* votes_ = nullptr;
  Skeleton skeleton_;
};

}  // namespace armature::tools
