#include "tracker/joints/joint_correction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace armature {
namespace {

constexpr std::array kTorso = {JointId::Chest, JointId::Torso,        JointId::Waist,
                               JointId::Neck,  JointId::LeftShoulder, JointId::RightShoulder};
constexpr float kTypicalDistance_m = 3;
constexpr float kMaxOffset_m = 2;
constexpr float kHalfConfidence_m = 0.10F;  // the expected error at which a joint is as good as not

/// Whose lengths a person keeps: thighs, shins, shoulders, hips, spine, neck, and what holds them together.
constexpr std::array<std::pair<JointId, JointId>, kCorrectionBones> kBones = {{
    {JointId::LeftHip, JointId::LeftKnee},
    {JointId::RightHip, JointId::RightKnee},
    {JointId::LeftKnee, JointId::LeftAnkle},
    {JointId::RightKnee, JointId::RightAnkle},
    {JointId::RightHip, JointId::LeftHip},
    {JointId::RightShoulder, JointId::LeftShoulder},
    {JointId::Waist, JointId::Neck},
    {JointId::Neck, JointId::Head},
    {JointId::Waist, JointId::LeftHip},
    {JointId::Waist, JointId::RightHip},
    {JointId::Neck, JointId::LeftShoulder},
    {JointId::Neck, JointId::RightShoulder},
}};

Eigen::Vector3f in_mirror(const Eigen::Vector3f& v) noexcept {
  return {-v.x(), v.y(), v.z()};
}

/// Of each pair of a left and a right joint their middle, in the place of the left one, and the vector from right to
/// left, in that of the right one.
std::array<float, 3 * kJointCount> middles_and_widths(const std::array<Eigen::Vector3f, kJointCount>& joints) noexcept {
  std::array<float, 3 * kJointCount> out{};
  for (std::size_t j = 0; j < kJointCount; ++j) {
    const auto joint = static_cast<JointId>(j), other = mirrored(joint);
    const Eigen::Vector3f &p = joints[j], &q = joints[index(other)];
    const Eigen::Vector3f number = joint <= other ? Eigen::Vector3f(0.5F * (p + q)) : Eigen::Vector3f(q - p);
    std::copy_n(number.data(), 3, out.begin() + static_cast<std::ptrdiff_t>(3 * j));
  }
  return out;
}

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

void RestingBody::add(const Skeleton& voted) noexcept {
  frames_ = std::min(frames_ + 1, kFrames);
  const CorrectionFrame frame(voted);
  for (std::size_t j = 0; j < kJointCount; ++j) {
    seen_[j] += (frame.seen(voted.joints[j].position) - seen_[j]) / static_cast<float>(frames_);
  }
}

RestingBody RestingBody::mirrored() const noexcept {
  RestingBody out = *this;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    out.seen_[j] = in_mirror(seen_[index(armature::mirrored(static_cast<JointId>(j)))]);
  }
  return out;
}

void correction_inputs(const Skeleton& skeleton, const RestingBody& resting, const CorrectionFrame& frame,
                       std::span<float, kCorrectionInputs> inputs) noexcept {
  std::array<Eigen::Vector3f, kJointCount> now;
  for (std::size_t j = 0; j < kJointCount; ++j) now[j] = frame.seen(skeleton.joints[j].position);
  const float distance_m = frame.origin().norm();

  float* next = inputs.data();
  next = std::ranges::copy(middles_and_widths(now), next).out;
  for (const Joint& joint : skeleton.joints) *next++ = joint.confidence;
  *next++ = distance_m > 0 ? frame.origin().y() / distance_m : 0;
  *next++ = distance_m / kTypicalDistance_m;
  next = std::ranges::copy(middles_and_widths(resting.seen()), next).out;
  for (const auto& [from, to] : kBones) {
    const auto length = [&, from = from, to = to](const auto& joints) {
      return (joints[index(to)] - joints[index(from)]).norm();
    };
    const float at_rest_m = length(resting.seen());
    *next++ = at_rest_m;
    *next++ = length(now) - at_rest_m;
  }
}

JointCorrection::Advice JointCorrection::ask(const Skeleton& skeleton, const RestingBody& resting) const noexcept {
  const CorrectionFrame frame(skeleton);
  std::array<float, kCorrectionInputs> inputs{};
  std::array<float, kCorrectionOutputs> outputs{};
  correction_inputs(skeleton, resting, frame, inputs);
  forest_->correction()->evaluate(inputs, outputs);
  Advice advice;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    advice.offset_m[j] = frame.turned_back({outputs[3 * j], outputs[3 * j + 1], outputs[3 * j + 2]});
    advice.error_m[j] = expected_error_m(outputs[3 * kJointCount + j]);
  }
  return advice;
}

void JointCorrection::apply(Skeleton& skeleton, const RestingBody& resting) const noexcept {
  if (forest_->correction() == nullptr) return;
  const Advice advice = ask(skeleton, resting), in_the_mirror = ask(mirrored(skeleton), resting.mirrored());
  const Eigen::Vector3f voted = skeleton[JointId::LeftHip].position - skeleton[JointId::RightHip].position;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    Joint& joint = skeleton.joints[j];
    if (joint.state == JointState::Lost) continue;
    const std::size_t other = index(mirrored(static_cast<JointId>(j)));
    const Eigen::Vector3f offset_m = 0.5F * (advice.offset_m[j] + in_mirror(in_the_mirror.offset_m[other]));
    if (!(offset_m.squaredNorm() <= kMaxOffset_m * kMaxOffset_m)) continue;  // a network that has gone wild
    joint.position += offset_m;
    const float error = 0.5F * (advice.error_m[j] + in_the_mirror.error_m[other]) / kHalfConfidence_m;
    joint.confidence = std::isfinite(error) ? 1 / (1 + error * error) : 0;
  }
  share_turn(voted, skeleton[JointId::LeftHip], skeleton[JointId::RightHip]);
}

}  // namespace armature
