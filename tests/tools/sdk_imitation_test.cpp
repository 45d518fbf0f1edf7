#include "tools/evaluation/sdk_imitation.h"

#include <random>

#include <gtest/gtest.h>

#include "tools/evaluation/skeleton_tracker.h"

namespace armature::tools {
namespace {

constexpr float kHabit = 0.5F;

/// Somebody who moves a wrist and a knee, and an SDK that lifts knees by half of what the wrist is lifted.
SeenTwice recording(int person, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> by(-0.2F, 0.2F);
  SeenTwice out;
  out.person = person;
  for (int t = 0; t < 60; ++t) {
    Skeleton ours;
    for (std::size_t j = 0; j < kJointCount; ++j) ours.joints[j].position = {0.01F * static_cast<float>(j), 0, 3};
    const float wrist = by(random);
    ours[JointId::LeftWrist].position.y() += wrist;
    ours[JointId::RightKnee].position.z() += by(random);
    Skeleton sdk = ours;
    sdk[JointId::RightKnee].position.y() += kHabit * wrist + 0.3F;
    out.ours.push_back(ours);
    out.sdk.push_back(sdk);
  }
  return out;
}

float largest_miss(const SeenTwice& truth, const std::vector<Skeleton>& imitated) {
  float largest = 0;
  for (std::size_t t = 0; t < imitated.size(); ++t) {
    for (const JointId id : kNavigationJoints) {
      // A constant offset is nobody's habit.
      const Eigen::Vector3f constant = id == JointId::RightKnee ? Eigen::Vector3f(0, 0.3F, 0) : Eigen::Vector3f::Zero();
      largest = std::max(largest, (imitated[t][id].position + constant - truth.sdk[t][id].position).norm());
    }
  }
  return largest;
}

TEST(SdkImitation, LearnsAHabitFromOthers) {
  const std::vector<SeenTwice> recordings = {recording(1, 5), recording(2, 6), recording(3, 7)};
  const auto imitated = imitate_sdk(recordings);
  ASSERT_EQ(imitated.size(), 3U);
  EXPECT_GT(largest_miss(recordings[0], recordings[0].ours), 0.08F);
  EXPECT_LT(largest_miss(recordings[0], imitated[0]), 0.03F);
}

TEST(SdkImitation, DoesNotLearnFromThePersonHerself) {
  const std::vector<SeenTwice> recordings = {recording(1, 5), recording(1, 6)};
  const auto imitated = imitate_sdk(recordings);
  for (std::size_t t = 0; t < imitated[0].size(); ++t) {
    EXPECT_EQ(imitated[0][t][JointId::RightKnee].position, recordings[0].ours[t][JointId::RightKnee].position);
  }
}

}  // namespace
}  // namespace armature::tools
