#pragma once

#include <memory>

#include "tracker/body/skeleton.h"
#include "tracker/forest/part_classifier.h"

namespace armature {

struct JointOptions {
  float bandwidth_m = 0.19F;          ///< of the mean shift; as wide as a Gaussian exp(-d^2/h^2) of h = 10 cm
  float observed_confidence = 0.25F;  ///< below this a joint is inferred
  int hold_frames = 15;               ///< how long an unseen joint is inferred from the past before it is lost
};

/// Classified pixels -> 30 joints and the user's position P. Every joint is the strongest mode of the votes that the
/// leaves cast for it (offsets from the surface point to the joint; Girshick et al. 2011), found by mean shift from
/// several starts, the previous frame's joint among them. Votes count by the area of their pixel. A joint with too few
/// votes is carried along with its neighbour in the body. Then the forest's correction, where it has one, moves all of
/// them (joint_correction.h). Last, with any forest, trunk and legs are moved to where the surface that the user had at
/// rest fits the one that is seen (body_fit.h), once 15 frames have shown it.
/// Owns its memory. Deterministic. Thread-safe: no. Realtime-safe: everything but the constructor.
class JointEstimator {
 public:
  /// `forest` is the one whose votes will come.
  explicit JointEstimator(std::shared_ptr<const Forest> forest, const JointOptions& options = {});
  ~JointEstimator();
  JointEstimator(JointEstimator&&) noexcept;
  JointEstimator& operator=(JointEstimator&&) noexcept;

  /// Forgets the past: a new user.
  void reset() noexcept;

  /// Corrections look at how the user is built, which is taken from the last frames until this says that it is known
  /// (and there were 15 at least): joints do not shift any more because she moves on. The surface that trunk and legs
  /// are fitted to is kept with it. reset() forgets both.
  void keep_build(bool keep) noexcept;

  /// With no pixels every joint is lost, at its last position.
  void estimate(const PartVotes& votes, Skeleton& out) noexcept;

  /// The skeleton of the last frame before its correction.
  [[nodiscard]] const Skeleton& voted() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace armature
