#include "tracker/joints/joint_correction.h"

#include <array>
#include <cmath>

namespace armature {
namespace {

constexpr std::array kTorso = {JointId::Chest, JointId::Torso,        JointId::Waist,
                               JointId::Neck,  JointId::LeftShoulder, JointId::RightShoulder};
constexpr float kTypicalDistance_m = 3;
constexpr float kMaxOffset_m = 2;
constexpr float kHalfConfidence_m = 0.10F;  // the expected error at which a joint is as good as not

/// Half of what lies between both hips as voted, half as corrected: in how far hips turn the two err independently, by
/// the person and by what her legs do. Their middle stays.
void share_turn(const Eigen::Vector3f& voted, Joint& left, Joint& right) noexcept {
  if (left.state == JointState::Lost || right.state == JointState::Lost) return;
  const Eigen::Vector3f change = 0.25F * (voted - (left.position - right.position));
  left.position += change;
  right.position -= change;
}

}  // namespace

CorrectionFrame::CorrectionFrame(const Skeleton& skeleton) noexcept : origin_(Eigen::Vector3f::Zero()) {
  for (const JointId joint : kTorso) origin_ += skeleton[joint].position;
  origin_ /= static_cast<float>(kTorso.size());
  const float ahead = std::sqrt(origin_.x() * origin_.x() + origin_.z() * origin_.z());
  if (ahead <= 0) return;
  cosine_ = origin_.z() / ahead;
  sine_ = origin_.x() / ahead;
}

void correction_inputs(const Skeleton& skeleton, const CorrectionFrame& frame,
                       std::span<float, kCorrectionInputs> inputs) noexcept {
  for (std::size_t j = 0; j < kJointCount; ++j) {
    const auto joint = static_cast<JointId>(j), other = mirrored(joint);
    const Eigen::Vector3f p = frame.seen(skeleton[joint].position), q = frame.seen(skeleton[other].position);
    const Eigen::Vector3f number = joint <= other ? Eigen::Vector3f(0.5F * (p + q)) : Eigen::Vector3f(q - p);
    for (std::size_t axis = 0; axis < 3; ++axis) inputs[3 * j + axis] = number[static_cast<Eigen::Index>(axis)];
    inputs[3 * kJointCount + j] = skeleton[joint].confidence;
  }
  const float distance_m = frame.origin().norm();
  inputs[4 * kJointCount] = distance_m > 0 ? frame.origin().y() / distance_m : 0;
  inputs[4 * kJointCount + 1] = distance_m / kTypicalDistance_m;
}

void JointCorrection::apply(Skeleton& skeleton) const noexcept {
  const Perceptron* network = forest_->correction();
  if (network == nullptr) return;
  const CorrectionFrame frame(skeleton);
  std::array<float, kCorrectionInputs> inputs{};
  std::array<float, kCorrectionOutputs> outputs{};
  correction_inputs(skeleton, frame, inputs);
  network->evaluate(inputs, outputs);
  const Eigen::Vector3f voted = skeleton[JointId::LeftHip].position - skeleton[JointId::RightHip].position;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    Joint& joint = skeleton.joints[j];
    if (joint.state == JointState::Lost) continue;
    const Eigen::Vector3f offset(outputs[3 * j], outputs[3 * j + 1], outputs[3 * j + 2]);
    if (!(offset.squaredNorm() <= kMaxOffset_m * kMaxOffset_m)) continue;  // a network that has gone wild
    joint.position += frame.turned_back(offset);
    const float error = expected_error_m(outputs[3 * kJointCount + j]) / kHalfConfidence_m;
    joint.confidence = std::isfinite(error) ? 1 / (1 + error * error) : 0;
  }
  share_turn(voted, skeleton[JointId::LeftHip], skeleton[JointId::RightHip]);
}

}  // namespace armature
