#include "tracker/daemon/frame_guard.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

namespace armature {
namespace {

using namespace std::chrono_literals;

TEST(FrameGuard, TellsFramesNobodyMaySteerByFromGoodOnes) {
  FrameGuard guard;
  DepthFrame frame;
  frame.intrinsics = {64, 48, 60, 60, 32, 24};
  frame.depth_mm.assign(64 * 48, 2000);
  std::uint16_t noise = 0;
  const auto next = [&](std::chrono::nanoseconds by_sensor = 33ms) {
    frame.depth_mm[0] = ++noise % 2 == 0 ? 2000 : 2001;
    frame.sensor.time += by_sensor;
    frame.host.time += 33ms;
    const char* complaint = guard.complaint(frame.view());
    return std::string(complaint == nullptr ? "" : complaint);
  };
  EXPECT_EQ(next(), "");
  EXPECT_EQ(next(), "");
  EXPECT_EQ(next(1h), "a jump of the sensor's clock");
  EXPECT_EQ(next(-1h + 66ms), "") << "and back";
  EXPECT_EQ(next(-1s), "a jump of the sensor's clock");
  for (int i = 0; i < 3; ++i) EXPECT_EQ(next(), "a jump of the sensor's clock");
  EXPECT_EQ(next(), "") << "the new normal";
  EXPECT_EQ(next(), "");
  std::fill(frame.depth_mm.begin() + 64 * 16, frame.depth_mm.end(), std::uint16_t{0});
  EXPECT_EQ(next(), "a torn frame");
  frame.depth_mm.assign(64 * 48, 2000);
  for (std::size_t i = 0; i < frame.depth_mm.size(); i += 3) frame.depth_mm[i] = 50000;
  for (int i = 0; i < 20; ++i) EXPECT_EQ(next(), "a garbage frame") << "never normal";
  frame.depth_mm.assign(64 * 47, 2000);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(next(), "a torn frame") << "never normal";
}

TEST(FrameGuard, NothingThatStandsStillIsEverNormal) {
  FrameGuard guard;
  DepthFrame frame;
  frame.intrinsics = {64, 48, 60, 60, 32, 24};
  frame.depth_mm.assign(64 * 48, 2000);
  const auto next = [&](bool noise = false, std::chrono::nanoseconds by_sensor = 33ms) {
    frame.depth_mm[64 * 40 + 63] += noise ? 1 : 0;  // a single pixel that is looked at
    frame.sensor.time += by_sensor;
    frame.host.time += 33ms;
    const char* complaint = guard.complaint(frame.view());
    return std::string(complaint == nullptr ? "" : complaint);
  };
  for (int i = 0; i < 4; ++i) EXPECT_EQ(next(), "") << "a frame may come again, " << i;
  for (int i = 0; i < 20; ++i) EXPECT_EQ(next(), "a frozen image");
  guard.start_over();
  EXPECT_EQ(next(), "a frozen image") << "also once it was silent";
  EXPECT_EQ(next(true), "");
  for (int i = 0; i < 20; ++i) EXPECT_EQ(next(true, 0ms), "a clock that stands still");
  guard.start_over();
  EXPECT_EQ(next(true, 0ms), "a clock that stands still");
  frame.depth_mm.assign(64 * 48, 0);
  for (int i = 0; i < 20; ++i) next();
  EXPECT_EQ(next(), "") << "who sees nothing sees it without noise";
}

TEST(FrameGuard, ACoveredLensIsBlindNotFrozen) {
  FrameGuard guard;
  DepthFrame frame;
  frame.intrinsics = {640, 480, 500, 500, 320, 240};
  frame.depth_mm.assign(640 * 480, 0);
  frame.depth_mm[640 * 80 + 7] = 2000;  // a pixel that always says so, in a row that is looked at
  for (int i = 0; i < 20; ++i) {
    frame.sensor.time += 33ms;
    frame.host.time += 33ms;
    EXPECT_EQ(guard.complaint(frame.view()), nullptr);
    EXPECT_FALSE(guard.sees());
  }
  frame.depth_mm.assign(640 * 480, 2000);
  frame.sensor.time += 33ms;
  frame.host.time += 33ms;
  EXPECT_EQ(guard.complaint(frame.view()), nullptr);
  EXPECT_TRUE(guard.sees());
}

TEST(FrameGuard, CallsASmallerImageWhatItIs) {
  FrameGuard guard;
  DepthFrame frame;
  frame.intrinsics = {64, 48, 60, 60, 32, 24};
  frame.depth_mm.assign(64 * 48, 2000);
  EXPECT_EQ(guard.complaint(frame.view()), nullptr);
  frame.intrinsics = {32, 24, 30, 30, 16, 12};
  frame.depth_mm.assign(32 * 24, 2000);
  frame.sensor.time += 33ms;
  frame.host.time += 33ms;
  EXPECT_STREQ(guard.complaint(frame.view()), "a frame of another size");
}

}  // namespace
}  // namespace armature
