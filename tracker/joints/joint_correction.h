#pragma once

#include <array>
#include <memory>
#include <span>

#include "tracker/body/skeleton.h"
#include "tracker/forest/forest.h"

namespace armature {

/// Where a skeleton is looked at from when it is corrected: beside its torso, in axes turned about the camera's y until
/// the torso lies straight ahead, so that it does not matter where in the image somebody stands.
class CorrectionFrame {
 public:
  explicit CorrectionFrame(const Skeleton& skeleton) noexcept;
  [[nodiscard]] Eigen::Vector3f seen(const Eigen::Vector3f& point) const noexcept { return turned(point - origin_); }
  [[nodiscard]] Eigen::Vector3f turned(const Eigen::Vector3f& v) const noexcept {
    return {cosine_ * v.x() - sine_ * v.z(), v.y(), sine_ * v.x() + cosine_ * v.z()};
  }
  [[nodiscard]] Eigen::Vector3f turned_back(const Eigen::Vector3f& v) const noexcept {
    return {cosine_ * v.x() + sine_ * v.z(), v.y(), cosine_ * v.z() - sine_ * v.x()};
  }
  [[nodiscard]] const Eigen::Vector3f& origin() const noexcept { return origin_; }

 private:
  Eigen::Vector3f origin_;  // the mean of the torso's joints, camera frame
  float cosine_ = 1, sine_ = 0;
};

/// What the votes say of somebody at rest: each joint as seen from the CorrectionFrame of its moment, metres, a mean
/// in which the last 15 frames weigh most. Builds differ by more than small motions: who knows a person at rest tells
/// the two apart.
class RestingBody {
 public:
  RestingBody() noexcept { seen_.fill(Eigen::Vector3f::Zero()); }

  void add(const Skeleton& voted) noexcept;
  /// Whether it is a mean of enough frames to be kept.
  [[nodiscard]] bool settled() const noexcept { return frames_ == kFrames; }
  [[nodiscard]] const std::array<Eigen::Vector3f, kJointCount>& seen() const noexcept { return seen_; }
  /// The same in a mirror.
  [[nodiscard]] RestingBody mirrored() const noexcept;

 private:
  static constexpr int kFrames = 15;
  std::array<Eigen::Vector3f, kJointCount> seen_;
  int frames_ = 0;
};

/// The numbers that a correction is made of: 30 joints in the frame, metres, of which each pair of a left and a right
/// one counts as its middle (in the place of the left one) and the vector from right to left (in that of the right
/// one), which tells turns apart from steps; their 30 confidences; how high the torso stands in view (the sine of its
/// elevation); its distance over 3 m; the joints at rest, in the same way; kCorrectionBones lengths at rest, and by how
/// much they are longer now.
void correction_inputs(const Skeleton& skeleton, const RestingBody& resting, const CorrectionFrame& frame,
                       std::span<float, kCorrectionInputs> inputs) noexcept;

/// Moves the joints that the votes of a forest agree on to where such joints have proved to be. Votes are means over
/// many poses and builds: they draw joints towards the average person and cannot know what another part of the body
/// tells about a hidden one. A small network learned from synthetic people puts both right, and says how large an error
/// to expect. It is asked of the person and of her mirror image, and answers with the mean.
/// Thread-safe: yes. Realtime-safe: yes.
class JointCorrection {
 public:
  explicit JointCorrection(std::shared_ptr<const Forest> forest) : forest_(std::move(forest)) {}

  /// Positions and confidences of `skeleton`, of somebody whom `resting` shows; a lost joint stays lost, and all stay
  /// where the forest knows no correction.
  void apply(Skeleton& skeleton, const RestingBody& resting) const noexcept;

 private:
  /// What the network says of each joint, camera frame.
  struct Advice {
    std::array<Eigen::Vector3f, kJointCount> offset_m;
    std::array<float, kJointCount> error_m{};
  };
  [[nodiscard]] Advice ask(const Skeleton& skeleton, const RestingBody& resting) const noexcept;

  std::shared_ptr<const Forest> forest_;
};

}  // namespace armature
