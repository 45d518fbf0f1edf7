#include "tracker/pipeline.h"

#include <gtest/gtest.h>

#include "tests/support/count_allocations.h"
#include "tracker/installation.h"
#include "tracker/synth/synth_source.h"

namespace armature {
namespace {

using namespace std::chrono_literals;

std::shared_ptr<const Forest> shipped_forest() {
  auto forest = Forest::load(installed_model());
  EXPECT_TRUE(forest) << forest.error().message;
  return forest ? std::make_shared<const Forest>(std::move(*forest)) : nullptr;
}

TEST(Pipeline, AllocatesNothingOnceItHasTakenItsMemory) {
  const auto forest = shipped_forest();
  ASSERT_TRUE(forest);
  auto source = SynthSource::open("walk_in?size=320x240&seed=3");
  ASSERT_TRUE(source);
  Pipeline pipeline(forest, {});
  pipeline.reset((*source)->info().intrinsics);
  DepthFrame frame;
  std::size_t during_process = 0;
  bool somebody = false;
  while (true) {
    const auto status = (*source)->read(frame, 1s);
    ASSERT_TRUE(status);
    if (*status != ReadStatus::Frame) break;
    const std::size_t before = test::allocations;
    somebody |= pipeline.process(frame.view()).tracking;
    during_process += test::allocations - before;
  }
  EXPECT_TRUE(somebody);
  EXPECT_EQ(during_process, 0U) << "an empty room, somebody who walks in, calibrates and steers";
}

TEST(Pipeline, GivesTheSameForTheSameFramesWhateverItSawBefore) {
  const auto forest = shipped_forest();
  ASSERT_TRUE(forest);
  TrackerOptions options;
  options.rest.mode = RestMode::Auto;
  const auto play = [&](Pipeline& pipeline) {
    auto source = SynthSource::open("lean_bust?size=160x120&seed=3");
    pipeline.reset((*source)->info().intrinsics);
    std::vector<float> all;
    DepthFrame frame;
    while (true) {
      const auto status = (*source)->read(frame, 1s);
      if (!status || *status != ReadStatus::Frame) return all;
      const TrackerOutput& output = pipeline.process(frame.view());
      for (const Joint& joint : output.skeleton.joints) all.push_back(joint.position.sum());
      for (const MotionOutput& motion : output.navigation.motions) all.push_back(motion.shaped);
    }
  };
  Pipeline fresh(forest, options), used(forest, options);
  const auto first = play(used);
  EXPECT_EQ(play(used), first);
  EXPECT_EQ(play(fresh), first);
}

TEST(Pipeline, StopsInTheFrameInWhichNobodyIsThereAnyMore) {
  const auto forest = shipped_forest();
  ASSERT_TRUE(forest);
  auto source = SynthSource::open("bend_knees?size=160x120&seed=3");
  ASSERT_TRUE(source);
  TrackerOptions options;
  options.rest.mode = RestMode::Auto;
  Pipeline pipeline(forest, options);
  DepthFrame frame;
  const TrackerOutput* output = nullptr;
  do {
    const auto status = (*source)->read(frame, 1s);
    ASSERT_TRUE(status && *status == ReadStatus::Frame) << "she never walked";
    output = &pipeline.process(frame.view());
  } while (output->navigation.velocity.linear_m_s == 0);
  std::fill(frame.depth_mm.begin(), frame.depth_mm.end(), std::uint16_t{0});
  frame.sensor.time += 33ms;
  output = &pipeline.process(frame.view());
  EXPECT_EQ(output->navigation.velocity.linear_m_s, 0);
  EXPECT_FALSE(output->tracking);
  EXPECT_EQ(output->stop, StopReason::TrackingLost);
}

TEST(Pipeline, TakesARestPoseThoughTheSensorsClockStartsAnewMeanwhile) {
  const auto forest = shipped_forest();
  ASSERT_TRUE(forest);
  Pipeline pipeline(forest, {});
  auto source = SynthSource::open("stand?size=160x120&seed=3");
  ASSERT_TRUE(source);
  DepthFrame frame;
  for (int seen = 0; seen < 90; ++seen) {
    const auto status = (*source)->read(frame, 1s);
    ASSERT_TRUE(status && *status == ReadStatus::Frame);
    frame.sensor.time = (seen < 15 ? 10'000s : 5s) + 33ms * seen;
    if (pipeline.process(frame.view()).state == EngagementState::Engaged) return;
  }
  FAIL() << "she stood still for two seconds and never steered";
}

TEST(Pipeline, CallsNoMotionNoisyOfSomebodyWhoSettlesOrComesBackToRest) {
  const auto forest = shipped_forest();
  ASSERT_TRUE(forest);
  for (const char* scene : {"bend_knees?size=320x240&seed=3", "pair_b?size=320x240&seed=1"}) {
    Pipeline pipeline(forest, {});
    auto source = SynthSource::open(scene);
    ASSERT_TRUE(source);
    bool engaged = false;
    DepthFrame frame;
    while (*(*source)->read(frame, 1s) == ReadStatus::Frame)
      for (const TrackerEvent& event : pipeline.process(frame.view()).events) {
        engaged = engaged || event.kind == TrackerEventKind::Engaged;
        EXPECT_NE(event.kind, TrackerEventKind::MotionTooNoisy) << scene;
      }
    EXPECT_TRUE(engaged);
  }
}

TEST(Pipeline, SaysWhomAnImageOfAnotherSizeMadeItForget) {
  const auto forest = shipped_forest();
  ASSERT_TRUE(forest);
  Pipeline pipeline(forest, {});
  auto source = SynthSource::open("stand?size=160x120&seed=3"), other = SynthSource::open("stand?size=320x240&seed=3");
  ASSERT_TRUE(source && other);
  DepthFrame frame;
  const TrackerOutput* output = nullptr;
  do {
    const auto status = (*source)->read(frame, 1s);
    ASSERT_TRUE(status && *status == ReadStatus::Frame) << "she never steered";
    output = &pipeline.process(frame.view());
  } while (output->state != EngagementState::Engaged);
  const std::uint8_t user = output->user;
  ASSERT_TRUE((*other)->read(frame, 1s));
  output = &pipeline.process(frame.view());
  ASSERT_GE(output->events.size(), 2U);
  EXPECT_EQ(output->events[0].kind, TrackerEventKind::Released);
  EXPECT_EQ(output->events[1].kind, TrackerEventKind::UserLeft);
  for (const TrackerEvent& event : output->events.first(2)) EXPECT_EQ(event.user, user);
}

}  // namespace
}  // namespace armature
