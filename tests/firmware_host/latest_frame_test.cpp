#include "firmware_host/latest_frame.h"

#include <algorithm>
#include <thread>

#include <gtest/gtest.h>

namespace armature {
namespace {

using namespace std::chrono_literals;

void publish(LatestFrame& latest, std::uint64_t sequence, std::size_t pixels = 4) {
  DepthFrame& frame = latest.slot();
  frame.sequence = sequence;
  frame.depth_mm.assign(pixels, static_cast<std::uint16_t>(sequence));
  latest.publish();
}

TEST(LatestFrame, HandsOverAFrameOnce) {
  LatestFrame latest;
  EXPECT_EQ(latest.take(0ns), nullptr);
  publish(latest, 7);
  const DepthFrame* frame = latest.take(0ns);
  ASSERT_NE(frame, nullptr);
  EXPECT_EQ(frame->sequence, 7U);
  EXPECT_EQ(latest.take(0ns), nullptr);
  EXPECT_EQ(latest.dropped(), 0U);
}

TEST(LatestFrame, KeepsTheNewestAndCountsTheOthers) {
  LatestFrame latest;
  for (std::uint64_t i = 0; i < 5; ++i) publish(latest, i);
  const DepthFrame* frame = latest.take(0ns);
  ASSERT_NE(frame, nullptr);
  EXPECT_EQ(frame->sequence, 4U);
  EXPECT_EQ(latest.dropped(), 4U);
  EXPECT_EQ(latest.take(0ns), nullptr);
}

TEST(LatestFrame, LeavesATakenFrameAlone) {
  LatestFrame latest;
  publish(latest, 1);
  const DepthFrame* frame = latest.take(0ns);
  ASSERT_NE(frame, nullptr);
  for (std::uint64_t i = 2; i < 9; ++i) publish(latest, i);
  EXPECT_EQ(frame->sequence, 1U);
  EXPECT_EQ(frame->depth_mm, std::vector<std::uint16_t>(4, 1));
}

TEST(LatestFrame, GivesUpWhenNothingComesInTime) {
  LatestFrame latest;
  EXPECT_EQ(latest.take(1ms), nullptr);
  EXPECT_FALSE(latest.finished());
}

TEST(LatestFrame, HandsOutTheLastFrameBeforeItFinishes) {
  LatestFrame latest;
  publish(latest, 3);
  latest.close();
  EXPECT_FALSE(latest.finished());
  const DepthFrame* frame = latest.take(1h);
  ASSERT_NE(frame, nullptr);
  EXPECT_EQ(frame->sequence, 3U);
  EXPECT_TRUE(latest.finished());
  EXPECT_EQ(latest.take(1h), nullptr);
  EXPECT_EQ(latest.take(1h), nullptr);
}

TEST(LatestFrame, NeitherTearsNorRepeatsNorLosesCountBetweenTwoThreads) {
  constexpr std::uint64_t kFrames = 20000;
  LatestFrame latest;
  std::thread capture([&] {
    for (std::uint64_t i = 1; i <= kFrames; ++i) publish(latest, i, 64 + i % 3);
    latest.close();
  });
  std::uint64_t taken = 0;
  std::uint64_t last = 0;
  while (!latest.finished()) {
    const DepthFrame* frame = latest.take(10s);
    if (frame == nullptr) continue;
    ++taken;
    ASSERT_GT(frame->sequence, last);
    last = frame->sequence;
    const auto expected = static_cast<std::uint16_t>(frame->sequence);
    ASSERT_EQ(frame->depth_mm.size(), 64 + frame->sequence % 3);
    ASSERT_TRUE(std::all_of(frame->depth_mm.begin(), frame->depth_mm.end(),
                            [expected](std::uint16_t depth) { return depth == expected; }));
  }
  capture.join();
  EXPECT_EQ(last, kFrames);
  EXPECT_EQ(taken + latest.dropped(), kFrames);
}

}  // namespace
}  // namespace armature
