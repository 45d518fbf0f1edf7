#include "tracker/motions/range_adapter.h"

#include <cmath>

#include <gtest/gtest.h>

namespace armature {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kLean = index(MotionId::LeanBust);

/// Leans to and fro as far as `reach` of the configured range, for so many seconds.
float range_after(RangeAdapter& adapter, float reach, int seconds, const AdaptationOptions& options,
                  const Skeleton& skeleton = {}) {
  PerMotion<MotionReading> readings{};
  float range = 0;
  for (int frame = 0; frame < seconds * 30; ++frame) {
    readings[kLean].measured = true;
    readings[kLean].angle_rad = reach * kDefaultRange_rad[kLean] * std::sin(static_cast<float>(frame) / 15);
    range = adapter.adapt(readings, kDefaultRange_rad, skeleton, 33ms, options)[kLean] / kDefaultRange_rad[kLean];
  }
  return range;
}

Skeleton with_bent_arm() {
  Skeleton skeleton;
  skeleton[JointId::RightShoulder] = {{0.2F, -0.4F, 2}, 1, JointState::Observed};
  skeleton[JointId::RightElbow] = {{0.2F, -0.1F, 2}, 1, JointState::Observed};
  skeleton[JointId::RightWrist] = {{0.1F, -0.15F, 1.8F}, 1, JointState::Observed};
  return skeleton;
}

TEST(RangeAdapter, FollowsThePersonSlowlyAndWithinBounds) {
  RangeAdapter adapter;
  const AdaptationOptions options{.enabled = true};
  EXPECT_NEAR(range_after(adapter, 1, 60, options), 0.98F, 0.05F);
  adapter.reset();
  EXPECT_GT(range_after(adapter, 0.8F, 2, options), 0.95F) << "slowly";
  EXPECT_NEAR(range_after(adapter, 0.8F, 60, options), 0.79F, 0.05F);
  EXPECT_EQ(range_after(adapter, 0.5F, 300, options), options.least);
  EXPECT_EQ(range_after(adapter, 3, 60, options), options.most);
}

TEST(RangeAdapter, DoesNotMoveAtRest) {
  RangeAdapter adapter;
  EXPECT_EQ(range_after(adapter, 0.3F, 300, {.enabled = true}), 1);
}

TEST(RangeAdapter, IsResetWithTheUserAndCanBeSwitchedOff) {
  RangeAdapter adapter;
  (void)range_after(adapter, 0.5F, 300, {.enabled = true});
  adapter.reset();
  EXPECT_GT(range_after(adapter, 0.3F, 1, {.enabled = true}), 0.99F);
  EXPECT_EQ(range_after(adapter, 0.5F, 300, {.enabled = false}), 1);
}

TEST(RangeAdapter, IsSmallerWhileSomethingIsCarried) {
  RangeAdapter adapter;
  const AdaptationOptions options{.enabled = true};
  EXPECT_EQ(range_after(adapter, 0.1F, 1, options, with_bent_arm()), 1) << "a gesture";
  EXPECT_FLOAT_EQ(range_after(adapter, 0.1F, 3, options, with_bent_arm()), options.carrying);
  EXPECT_EQ(range_after(adapter, 0.1F, 5, options), 1) << "put down";
}

}  // namespace
}  // namespace armature
