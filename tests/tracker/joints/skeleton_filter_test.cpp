#include "tracker/joints/skeleton_filter.h"

#include <numbers>

#include <gtest/gtest.h>

namespace armature {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3f;

constexpr std::chrono::nanoseconds kFrame = 33ms;

/// All joints in one place.
Skeleton at(const Vector3f& place) {
  Skeleton skeleton;
  for (Joint& joint : skeleton.joints) joint = {.position = place, .confidence = 0.7F, .state = JointState::Observed};
  skeleton.user_position = place;
  return skeleton;
}

Skeleton filtered(SkeletonFilter& filter, Skeleton skeleton, std::chrono::nanoseconds time) {
  filter.filter(skeleton, time);
  return skeleton;
}

TEST(SkeletonFilter, TheFirstFrameStaysAsItIs) {
  SkeletonFilter filter;
  const Skeleton out = filtered(filter, at({0.1F, 0.2F, 2}), 1s);
  EXPECT_EQ(out[JointId::Head].position, Vector3f(0.1F, 0.2F, 2));
  EXPECT_EQ(out.user_position, Vector3f(0.1F, 0.2F, 2));
  EXPECT_EQ(out[JointId::Head].confidence, 0.7F);
  EXPECT_EQ(out[JointId::Head].state, JointState::Observed);
}

TEST(SkeletonFilter, AJointThatTremblesIsCalmed) {
  SkeletonFilter filter;
  float most = 0;
  for (int t = 0; t < 60; ++t) {
    const float x = t % 2 == 0 ? 0.003F : -0.003F;
    const Skeleton out = filtered(filter, at({x, 0, 2}), t * kFrame);
    if (t >= 30) most = std::max(most, std::abs(out[JointId::LeftKnee].position.x()));
  }
  EXPECT_LT(most, 0.001F);
}

TEST(SkeletonFilter, ADriftAsSlowAsNoiseOpensNothing) {
  SkeletonFilter filter;
  constexpr float kDrift_m_s = 0.09F;
  float late_m = 0;
  for (int t = 0; t < 90; ++t) {
    const float x = kDrift_m_s * std::chrono::duration<float>(t * kFrame).count();
    late_m = x - filtered(filter, at({x, 0, 2}), t * kFrame)[JointId::Head].position.x();
  }
  // That of a low-pass with the cutoff at rest.
  const float expected_m = kDrift_m_s / (2 * std::numbers::pi_v<float> * SkeletonFilter::kDefault.min_cutoff_hz);
  EXPECT_NEAR(late_m, expected_m, 0.01F * expected_m);
}

TEST(SkeletonFilter, AFastJointIsHardlyLate) {
  SkeletonFilter filter;
  float late_m = 0;
  for (int t = 0; t < 30; ++t) {
    const float x = 1.5F * std::chrono::duration<float>(t * kFrame).count();  // a wave of the hand
    late_m = x - filtered(filter, at({x, 0, 2}), t * kFrame)[JointId::RightHand].position.x();
  }
  EXPECT_LT(late_m, 1.5F * std::chrono::duration<float>(kFrame).count());
}

TEST(SkeletonFilter, AJointThatIsLessSureThanUsualIsHeldBackButNotForEver) {
  SkeletonFilter filter, trusting;
  for (int t = 0; t < 60; ++t) {
    (void)filtered(filter, at({0, 0, 2}), t * kFrame);
    (void)filtered(trusting, at({0, 0, 2}), t * kFrame);
  }
  const auto elsewhere = [](float confidence) {
    Skeleton skeleton = at({0.3F, 0, 2});
    for (Joint& joint : skeleton.joints) joint.confidence = confidence;
    return skeleton;
  };
  float held = 0, followed = 0;
  for (int t = 60; t < 70; ++t) {
    held = filtered(filter, elsewhere(0.1F), t * kFrame)[JointId::LeftKnee].position.x();
    followed = filtered(trusting, elsewhere(0.7F), t * kFrame)[JointId::LeftKnee].position.x();
  }
  EXPECT_LT(held, 0.12F);
  EXPECT_GT(followed, 0.25F);
  int t = 70;
  for (; t < 600; ++t) held = filtered(filter, elsewhere(0), t * kFrame)[JointId::LeftKnee].position.x();
  EXPECT_GT(held, 0.25F);
  // Behind a counter: after half a minute that is how sure the joint usually is, and a low-pass with the cutoff at rest
  // is all that is left.
  for (; t < 980; ++t) (void)filtered(filter, elsewhere(0), t * kFrame);
  constexpr float kWalk_m_s = 0.5F;
  Skeleton walking = elsewhere(0);
  float late_m = 0;
  for (const int begin = t; t < begin + 60; ++t) {
    for (Joint& joint : walking.joints) joint.position.x() += kWalk_m_s * std::chrono::duration<float>(kFrame).count();
    late_m =
        walking[JointId::LeftKnee].position.x() - filtered(filter, walking, t * kFrame)[JointId::LeftKnee].position.x();
  }
  EXPECT_LT(late_m, 1.05F * kWalk_m_s / (2 * std::numbers::pi_v<float> * SkeletonFilter::kDefault.min_cutoff_hz));
}

TEST(SkeletonFilter, ALostJointIsLeftAloneAndStartsAnewWhenItIsFound) {
  SkeletonFilter filter;
  for (int t = 0; t < 10; ++t) (void)filtered(filter, at({0, 0, 2}), t * kFrame);
  Skeleton lost = at({1, 0, 2});
  lost[JointId::LeftHand].state = JointState::Lost;
  EXPECT_EQ(filtered(filter, lost, 10 * kFrame)[JointId::LeftHand].position, Vector3f(1, 0, 2));
  EXPECT_EQ(filtered(filter, at({2, 0, 2}), 11 * kFrame)[JointId::LeftHand].position, Vector3f(2, 0, 2));
}

TEST(SkeletonFilter, AfterAGapAndWhenTimeRunsBackwardsItStartsAnew) {
  SkeletonFilter filter;
  (void)filtered(filter, at({0, 0, 2}), 5s);
  EXPECT_EQ(filtered(filter, at({1, 0, 2}), 6s)[JointId::Head].position, Vector3f(1, 0, 2));
  EXPECT_EQ(filtered(filter, at({0, 0, 2}), 4s)[JointId::Head].position, Vector3f(0, 0, 2));
  filter.reset();
  EXPECT_EQ(filtered(filter, at({3, 0, 2}), 4s + kFrame)[JointId::Head].position, Vector3f(3, 0, 2));
}

}  // namespace
}  // namespace armature
