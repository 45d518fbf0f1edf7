#include <fstream>

#include <gtest/gtest.h>

#include "firmware_host/depth_source.h"
#include "firmware_host/recording/recorder.h"
#include "tests/firmware_host/sample_frames.h"
#include "tests/support/temporary_directory.h"

namespace armature {
namespace {

using namespace std::chrono_literals;
using test::FrameSource;
using test::record;
using test::sample_frames;
using test::TemporaryDirectory;

std::unique_ptr<DepthSource> replay(const std::filesystem::path& path, const OpenOptions& options = {}) {
  auto source = open_depth_source("oni:" + path.string(), options);
  EXPECT_TRUE(source) << source.error().message;
  return source ? std::move(*source) : nullptr;
}

void expect_replay(const std::filesystem::path& path, const std::vector<DepthFrame>& frames) {
  const auto source = replay(path);
  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().frame_count, static_cast<long>(frames.size()));
  DepthFrame frame;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto status = source->read(frame, 1s);
    ASSERT_TRUE(status) << status.error().message;
    ASSERT_EQ(*status, ReadStatus::Frame);
    ASSERT_EQ(frame.depth_mm, frames[i].depth_mm) << "frame " << i;
    EXPECT_EQ(frame.intrinsics, frames[i].intrinsics);
    EXPECT_EQ(frame.sequence, i);
    EXPECT_EQ(frame.sensor.clock, ClockId::Recording);
    EXPECT_EQ(frame.sensor.time, frames[i].sensor.time - frames[0].sensor.time);
  }
  EXPECT_EQ(source->read(frame, 1s).value(), ReadStatus::EndOfStream);
  EXPECT_EQ(source->read(frame, 1s).value(), ReadStatus::EndOfStream);
}

class RecordingOfSize : public testing::TestWithParam<std::pair<int, int>> {};

TEST_P(RecordingOfSize, ReplayIsBitIdenticalToWhatWentIn) {
  const TemporaryDirectory folder;
  const auto [width, height] = GetParam();
  const auto frames = sample_frames(width, height, 12);
  record(folder / "a.oni", frames);
  expect_replay(folder / "a.oni", frames);
}

INSTANTIATE_TEST_SUITE_P(Sizes, RecordingOfSize,
                         testing::Values(std::pair{1, 1}, std::pair{7, 3}, std::pair{160, 120}, std::pair{320, 240},
                                         std::pair{640, 480}, std::pair{641, 479}, std::pair{1600, 1200}));

TEST(Recording, ReplayTwiceGivesTheSame) {
  const TemporaryDirectory folder;
  const auto frames = sample_frames(160, 120, 30);
  record(folder / "a.oni", frames);
  for (int i = 0; i < 3; ++i) expect_replay(folder / "a.oni", frames);
}

TEST(Recording, TwoSourcesReplayOneFileSideBySide) {
  const TemporaryDirectory folder;
  const auto frames = sample_frames(160, 120, 20);
  record(folder / "a.oni", frames);
  const auto first = replay(folder / "a.oni");
  DepthFrame frame;
  ASSERT_EQ(first->read(frame, 1s).value(), ReadStatus::Frame);
  expect_replay(folder / "a.oni", frames);
  ASSERT_EQ(first->read(frame, 1s).value(), ReadStatus::Frame);
  EXPECT_EQ(frame.depth_mm, frames[1].depth_mm);
}

}  // namespace
}  // namespace armature
