#include "tracker/navigator.h"

#include <random>

#include <gtest/gtest.h>

#include "tests/tracker/motions/standing_person.h"

namespace armature {
namespace {

using namespace std::chrono_literals;
using test::standing_person;
using enum JointId;

constexpr std::chrono::nanoseconds kFrame = 33333us;
const Eigen::Vector3f kUp = -Eigen::Vector3f::UnitY();

/// Feeds frames at 30 Hz with a little noise of a fixed seed.
class Feed {
 public:
  Feed(Navigator& navigator, float noise_m) : navigator_(navigator), noise_m_(noise_m) {}

  const Navigation& frame(Skeleton skeleton) {
    for (Joint& joint : skeleton.joints) {
      for (int axis = 0; axis < 3; ++axis) joint.position[axis] += noise_m_ * noise_(random_);
    }
    time_ += kFrame;
    return navigator_.process(skeleton, kUp, time_);
  }
  void stand(int frames) {
    for (int i = 0; i < frames; ++i) frame(standing_person());
  }
  void pause(std::chrono::nanoseconds by) { time_ += by; }

 private:
  Navigator& navigator_;
  float noise_m_;
  std::mt19937 random_{7};
  std::normal_distribution<float> noise_;
  std::chrono::nanoseconds time_{0};
};

Skeleton right_knee_forward(float by_m) {
  Skeleton person = standing_person();
  person[RightKnee].position.z() -= by_m;
  return person;
}

TEST(Navigator, LearnsTheRestPoseFromOneSecondOfStillness) {
  Navigator navigator({}, {.mode = RestMode::Stillness});
  Feed feed(navigator, 0.005F);
  feed.stand(20);
  EXPECT_FALSE(navigator.rest().rest());
  feed.stand(20);
  ASSERT_TRUE(navigator.rest().rest());
  EXPECT_NEAR(navigator.rest().rest()->skeleton[LeftKnee].position.x(), 0.13F, 0.005F);
}

TEST(Navigator, DoesNotTakeAMovingPersonsPoseForRest) {
  Navigator navigator({}, {.mode = RestMode::Stillness});
  Feed feed(navigator, 0);
  for (int i = 0; i < 60; ++i) {
    Skeleton walking = standing_person();
    for (Joint& joint : walking.joints) joint.position.x() += 0.01F * static_cast<float>(i);
    feed.frame(walking);
  }
  EXPECT_FALSE(navigator.rest().rest());
  EXPECT_EQ(navigator.navigation().velocity.linear_m_s, 0);
}

TEST(Navigator, OfflineStartsAfterTenFramesAndImprovesTheRestPose) {
  Navigator navigator({}, {.mode = RestMode::Auto});
  Feed feed(navigator, 0.01F);
  feed.stand(10);
  ASSERT_TRUE(navigator.rest().rest());
  const float first = std::abs(navigator.rest().rest()->skeleton[RightHip].position.x() + 0.11F);
  feed.stand(80);
  const float later = std::abs(navigator.rest().rest()->skeleton[RightHip].position.x() + 0.11F);
  EXPECT_LT(later, std::max(first, 0.0025F));
}

TEST(Navigator, WalksWhenAKneeBendsAndStandsAtOnceWhenItIsBack) {
  Navigator navigator({}, {.mode = RestMode::First});
  Feed feed(navigator, 0.001F);
  feed.stand(10);
  for (int i = 0; i < 30; ++i) feed.frame(right_knee_forward(0.15F));
  EXPECT_GT(navigator.navigation().velocity.linear_m_s, 0.5F);
  EXPECT_EQ(navigator.navigation().velocity.angular_rad_s, 0);
  feed.stand(15);
  EXPECT_EQ(navigator.navigation().velocity.linear_m_s, 0);
}

TEST(Navigator, AtRestBothVelocitiesAreExactlyZeroDespiteNoise) {
  Navigator navigator({}, {.mode = RestMode::Auto});
  Feed feed(navigator, 0.008F);
  feed.stand(10);
  int moving = 0;
  for (int i = 0; i < 1000; ++i) {
    const CameraVelocity v = feed.frame(standing_person()).velocity;
    moving += v.linear_m_s != 0 || v.angular_rad_s != 0;
  }
  EXPECT_LE(moving, 1);
}

TEST(Navigator, StopsAtOnceWhenTrackingIsLostAndStartsFromAStandstillAfterwards) {
  Navigator navigator({}, {.mode = RestMode::First});
  Feed feed(navigator, 0);
  feed.stand(10);
  for (int i = 0; i < 30; ++i) feed.frame(right_knee_forward(0.15F));
  EXPECT_EQ(navigator.stop().velocity.linear_m_s, 0);
  EXPECT_LE(feed.frame(right_knee_forward(0.15F)).velocity.linear_m_s, 0.15F) << "one frame of acceleration";
  feed.pause(2s);
  EXPECT_LE(feed.frame(right_knee_forward(0.15F)).velocity.linear_m_s, 0.15F) << "a gap in the stream is a stop";
}

TEST(Navigator, SpeedsUpByAFramesStepWhereItWasHeldInAGapHoweverLongThatWas) {
  Navigator navigator({}, {.mode = RestMode::First});
  Feed feed(navigator, 0);
  feed.stand(10);
  for (int i = 0; i < 30; ++i) feed.frame(right_knee_forward(0.15F));
  ASSERT_GT(navigator.navigation().velocity.linear_m_s, 0.5F);
  navigator.hold();
  EXPECT_EQ(navigator.navigation().velocity.linear_m_s, 0);
  feed.pause(300ms);
  const float first_m_s = feed.frame(right_knee_forward(0.15F)).velocity.linear_m_s;
  EXPECT_GT(first_m_s, 0.0F) << "the rest pose stays";
  EXPECT_LE(first_m_s, 0.1F);
  const float second_m_s = feed.frame(right_knee_forward(0.15F)).velocity.linear_m_s;
  EXPECT_NEAR(second_m_s, first_m_s + 0.1F, 0.001F);
}

TEST(Navigator, HoldsAMotionOfHiddenJointsBrieflyAndThenCallsItZero) {
  Navigator navigator({}, {.mode = RestMode::First});
  Feed feed(navigator, 0);
  feed.stand(10);
  for (int i = 0; i < 30; ++i) feed.frame(right_knee_forward(0.15F));
  Skeleton hidden = right_knee_forward(0);
  hidden[RightKnee].confidence = 0;
  EXPECT_GT(feed.frame(hidden).walk, 0.3F);
  for (int i = 0; i < 6; ++i) feed.frame(hidden);
  EXPECT_EQ(navigator.navigation().walk, 0);
}

TEST(Navigator, SaysWhenASteeringMotionIsTooNoisyAndDoesNotSteerWithIt) {
  Navigator navigator({}, {.mode = RestMode::First, .first_frames = 30});
  Feed feed(navigator, 0.08F);
  feed.stand(31);
  EXPECT_TRUE(navigator.navigation().too_noisy);
  EXPECT_EQ(feed.frame(right_knee_forward(0.3F)).walk, 0);
}

}  // namespace
}  // namespace armature
