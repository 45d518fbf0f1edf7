#include "firmware_host/backends/openni2_device.h"

#include <cmath>

#include <gtest/gtest.h>

namespace armature {
namespace {

using namespace std::chrono_literals;

TEST(OpenNI2Device, ComesInMillimetresWithItsFieldOfViewAndItsOwnTime) {
  for (const char* uri : {"", "test:sensor"}) {
    auto source = open_openni2_device(uri, {});
    ASSERT_TRUE(source) << source.error().message;
    const Intrinsics& k = (*source)->info().intrinsics;
    EXPECT_EQ(k.width, 64);
    EXPECT_NEAR(k.focal_x_px, 32 / std::tan(0.5), 1e-4);
    EXPECT_EQ((*source)->info().frames_per_second, 60);
    DepthFrame frame;
    for (int times = 0; times < 5; ++times) {
      ReadStatus status = ReadStatus::Timeout;
      for (int i = 0; i < 50 && status == ReadStatus::Timeout; ++i) status = (*source)->read(frame, 200ms).value();
      ASSERT_EQ(status, ReadStatus::Frame);
      EXPECT_EQ(frame.depth_mm, std::vector<std::uint16_t>(64 * 48, static_cast<std::uint16_t>(1000 + frame.sequence)));
      EXPECT_EQ(frame.sensor.time, frame.sequence * 16'667us);
      EXPECT_EQ(frame.sensor.clock, ClockId::Device);
    }
    EXPECT_TRUE((*source)->recover(RecoverBy::RestartingStream));
    EXPECT_EQ((*source)->read(frame, 5s).value(), ReadStatus::Frame);
  }
}

TEST(OpenNI2Device, WhatIsNotThereIsOneClearError) {
  const auto source = open_openni2_device("test:nothing", {});
  ASSERT_FALSE(source);
  EXPECT_EQ(source.error().message.find("openni2:test:nothing: does not open"), 0U) << source.error().message;
}

}  // namespace
}  // namespace armature
