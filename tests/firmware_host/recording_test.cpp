#include <cstdlib>
#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "firmware_host/depth_source.h"
#include "firmware_host/recording/depth_codec.h"
#include "firmware_host/recording/file_reader.h"
#include "firmware_host/recording/oni_layout.h"
#include "firmware_host/recording/recorder.h"
#include "tests/firmware_host/oni_bytes.h"
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

void write(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

std::string open_error(const std::filesystem::path& path) {
  const auto source = open_depth_source("oni:" + path.string());
  return source ? "" : source.error().message;
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

TEST(Recording, APlainOpenNI2ProgramReadsIt) {
  const TemporaryDirectory folder;
  const auto frames = sample_frames(320, 240, 10);
  record(folder / "a.oni", frames, 29.97);
  const std::string command = std::string(PLAIN_OPENNI2_PROGRAM) + " '" + (folder / "a.oni").string() + "' '" +
                              (folder / "played").string() + "'";
  ASSERT_EQ(std::system(command.c_str()), 0);
  std::ifstream played(folder / "played", std::ios::binary);
  std::string line;
  std::getline(played, line);
  EXPECT_EQ(line, "320 240 30 10");
  for (const DepthFrame& frame : frames) {
    std::uint64_t time_us = 0;
    std::vector<std::uint16_t> depth(frame.depth_mm.size());
    played.read(reinterpret_cast<char*>(&time_us), sizeof time_us);
    played.read(reinterpret_cast<char*>(depth.data()), static_cast<std::streamsize>(2 * depth.size()));
    ASSERT_TRUE(played);
    EXPECT_EQ(std::chrono::microseconds(time_us), frame.sensor.time);
    EXPECT_EQ(depth, frame.depth_mm);
  }
}

TEST(Recording, OurOwnDecoderAgreesWithOpenNI2) {
  const TemporaryDirectory folder;
  const auto frames = sample_frames(97, 31, 8);
  record(folder / "a.oni", frames);
  const auto file = FileReader::open(folder / "a.oni");
  ASSERT_TRUE(file) << file.error().message;
  const auto layout = read_oni_layout(*file, "a.oni");
  ASSERT_TRUE(layout) << layout.error().message;
  EXPECT_EQ(layout->codec, DepthCodec::TableDifferences);
  ASSERT_EQ(layout->frames.size(), frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    std::vector<std::byte> payload(layout->frames[i].payload_bytes);
    std::vector<std::uint16_t> depth(frames[i].depth_mm.size());
    ASSERT_TRUE(file->read_at(layout->frames[i].payload_offset, payload));
    ASSERT_TRUE(decode_depth(layout->codec, payload, depth));
    EXPECT_EQ(depth, frames[i].depth_mm);
  }
}

TEST(Recording, OpenNI2PlaysWhatOurOwnBytesSay) {
  const TemporaryDirectory folder;
  write(folder / "a.oni", test::small_recording().bytes);
  const auto source = replay(folder / "a.oni");
  ASSERT_TRUE(source);
  DepthFrame frame;
  ASSERT_EQ(source->read(frame, 1s).value(), ReadStatus::Frame);
  EXPECT_EQ(frame.depth_mm, (std::vector<std::uint16_t>{1, 2, 3, 4, 5, 6, 7, 8}));
  ASSERT_EQ(source->read(frame, 1s).value(), ReadStatus::Frame);
  EXPECT_EQ(frame.depth_mm[0], 1000);
  EXPECT_EQ(frame.sensor.time, 100ms);
  EXPECT_EQ(source->read(frame, 1s).value(), ReadStatus::EndOfStream);
}

TEST(Recording, TakesTheFieldOfViewWhereThereIsNoSidecar) {
  const TemporaryDirectory folder;
  const auto frames = sample_frames(160, 120, 2);
  record(folder / "a.oni", frames, 15);
  std::filesystem::remove(folder / "a.oni.toml");
  const auto source = replay(folder / "a.oni");
  ASSERT_TRUE(source);
  const Intrinsics& k = source->info().intrinsics;
  // The field of view is stored as a 32-bit float.
  EXPECT_NEAR(k.focal_x_px, frames[0].intrinsics.focal_x_px, 1e-3);
  EXPECT_NEAR(k.focal_y_px, frames[0].intrinsics.focal_y_px, 1e-3);
  EXPECT_EQ(k.centre_x_px, 80);
  EXPECT_EQ(k.centre_y_px, 60);
  EXPECT_EQ(source->info().frames_per_second, 15);
}

TEST(Recording, RefusesASidecarOfAnotherRecording) {
  const TemporaryDirectory folder;
  record(folder / "a.oni", sample_frames(160, 120, 2));
  record(folder / "b.oni", sample_frames(120, 160, 2));
  std::filesystem::copy_file(folder / "b.oni.toml", folder / "a.oni.toml",
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_NE(open_error(folder / "a.oni").find("a.oni.toml: says 120 x 160: expected 160 x 120"), std::string::npos);
  write(folder / "a.oni.toml", "version = 1\nwidth = 'x'\n");
  EXPECT_NE(open_error(folder / "a.oni").find("a.oni.toml:2: width"), std::string::npos);
}

TEST(Recording, ReplaysInRealTimeByTheInjectedClock) {
  const TemporaryDirectory folder;
  record(folder / "a.oni", sample_frames(16, 12, 3));  // at 0, 33334 and 66668 microseconds
  const auto clock = std::make_shared<ManualClock>();
  clock->advance(5s);
  const auto source = replay(folder / "a.oni", {Pacing::RealTime, clock});
  ASSERT_TRUE(source);
  DepthFrame frame;
  ASSERT_EQ(source->read(frame, 1s).value(), ReadStatus::Frame);
  EXPECT_EQ(clock->now(), 5s);
  EXPECT_EQ(frame.host, (Timestamp{5s, ClockId::HostMonotonic}));
  EXPECT_EQ(source->read(frame, 30ms).value(), ReadStatus::Timeout);
  EXPECT_EQ(clock->now(), 5s + 30ms);
  ASSERT_EQ(source->read(frame, 30ms).value(), ReadStatus::Frame);
  EXPECT_EQ(clock->now(), 5s + 33334us);
  clock->advance(1s);  // a reader that came late gets the next one at once, and none is lost
  ASSERT_EQ(source->read(frame, 30ms).value(), ReadStatus::Frame);
  EXPECT_EQ(frame.sequence, 2U);
  EXPECT_EQ(source->read(frame, 30ms).value(), ReadStatus::EndOfStream);
}

TEST(Recording, StoresTheDepthsNextToTheCodecsLimit) {
  const TemporaryDirectory folder;
  auto frames = sample_frames(64, 64, 1);
  for (std::size_t i = 0; i < frames[0].depth_mm.size(); ++i)
    frames[0].depth_mm[i] = static_cast<std::uint16_t>(65534 - i % 300 * (i % 2));
  record(folder / "a.oni", frames);
  expect_replay(folder / "a.oni", frames);
}

TEST(Recording, RefusesFramesThatTheFormatCannotHold) {
  const TemporaryDirectory folder;
  const auto frames = sample_frames(320, 240, 1);
  const RecordingFacts facts{frames[0].intrinsics, 30, "test"};
  const auto error_of = [&](DepthFrame frame) {
    auto recorder = Recorder::create(folder / "a.oni", facts);
    if (!recorder) return recorder.error().message;
    const auto appended = recorder->append(frame.view());
    return appended ? std::string() : appended.error().message;
  };
  DepthFrame frame = frames[0];
  frame.depth_mm[5] = 65535;
  EXPECT_NE(error_of(frame).find("a.oni: frame 0: holds a depth of 65535 mm"), std::string::npos);
  for (std::size_t i = 0; i < frame.depth_mm.size(); ++i) frame.depth_mm[i] = static_cast<std::uint16_t>(i % 40000);
  EXPECT_NE(error_of(frame).find("more than 32768 different depths"), std::string::npos);
  for (std::size_t i = 0; i < frame.depth_mm.size(); ++i) frame.depth_mm[i] = static_cast<std::uint16_t>(i % 32768);
  EXPECT_EQ(error_of(frame), "");
  EXPECT_NE(error_of(sample_frames(240, 320, 1)[0]).find("240 x 320: expected 320 x 240"), std::string::npos);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Recording, StoresAsManyDifferentDepthsAsTheCodecCan) {
  const TemporaryDirectory folder;
  auto frames = sample_frames(320, 240, 2);
  for (std::size_t i = 0; i < frames[0].depth_mm.size(); ++i) {
    frames[0].depth_mm[i] = static_cast<std::uint16_t>(i % 32768 * 2);
    frames[1].depth_mm[i] = static_cast<std::uint16_t>(i * 7919 % 32768 * 2);
  }
  record(folder / "a.oni", frames);
  expect_replay(folder / "a.oni", frames);
}

TEST(Recording, LeavesNothingBehindWhenItIsNotFinished) {
  const TemporaryDirectory folder;
  const auto frames = sample_frames(16, 12, 2);
  write(folder / "a.oni", "an older recording");
  {
    auto recorder = Recorder::create(folder / "a.oni", {frames[0].intrinsics, 30, "test"});
    ASSERT_TRUE(recorder) << recorder.error().message;
    ASSERT_TRUE(recorder->append(frames[0].view()));
  }
  FrameSource empty({});
  EXPECT_FALSE(write_recording(folder / "b.oni", empty));
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    EXPECT_EQ(entry.path().filename(), "a.oni");
    ++files;
  }
  EXPECT_EQ(files, 1U);
  EXPECT_EQ(std::filesystem::file_size(folder / "a.oni"), std::string("an older recording").size());
}

TEST(Recording, StopsWhereItIsTold) {
  const TemporaryDirectory folder;
  const auto frames = sample_frames(16, 12, 9);
  FrameSource by_count(frames);
  EXPECT_EQ(write_recording(folder / "a.oni", by_count, {.max_frames = 4}).value(), 4U);
  FrameSource by_time(frames);
  EXPECT_EQ(write_recording(folder / "a.oni", by_time, {.max_duration = 100ms}).value(), 3U);
  std::stop_source stop;
  FrameSource stopped(frames);
  const auto after_two = [&](std::uint64_t count) {
    if (count == 2) stop.request_stop();
  };
  EXPECT_EQ(write_recording(folder / "a.oni", stopped, {.stop = stop.get_token(), .progress = after_two}).value(), 2U);
  expect_replay(folder / "a.oni", {frames[0], frames[1]});
  FrameSource refused(frames);
  const auto nothing =
      write_recording(folder / "b.oni", refused, {.stop = stop.get_token(), .keep_when_stopped = false});
  ASSERT_FALSE(nothing);
  EXPECT_NE(nothing.error().message.find("b.oni: interrupted"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "b.oni"));
}

TEST(Recording, GoesOnByTheHostWhereALiveSensorsClockBeginsAnew) {
  const TemporaryDirectory folder;
  auto frames = sample_frames(16, 12, 8);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].host.time = 100s + static_cast<int>(i) * 40ms + (i >= 5 ? 2s : 0s);
    frames[i].sensor.time = i < 5 ? 70h + static_cast<int>(i) * 40ms : static_cast<int>(i - 5) * 40ms;
  }
  FrameSource recorded_again(frames);
  EXPECT_FALSE(write_recording(folder / "a.oni", recorded_again)) << "a recording has no other clock";
  FrameSource live(frames);
  live.go_live();
  int remarks = 0;
  EXPECT_EQ(write_recording(folder / "a.oni", live, {.remark = [&](std::string_view) { ++remarks; }}).value(), 8U);
  EXPECT_EQ(remarks, 1);
  for (auto& frame : frames) frame.sensor.time = frame.host.time;
  expect_replay(folder / "a.oni", frames);
}

TEST(Recording, KeepsTheGapOfAStreamThatWasRestarted) {
  const TemporaryDirectory folder;
  auto frames = sample_frames(16, 12, 6);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].host.time = 100s + static_cast<int>(i) * 40ms + (i >= 3 ? 700ms : 0ms);
    frames[i].sensor.time = static_cast<int>(i) * 40ms - (i >= 3 ? 40ms - 16ns : 0ms);  // its counter began anew
  }
  FrameSource live(frames);
  live.go_live();
  ASSERT_EQ(write_recording(folder / "a.oni", live).value(), 6U);
  for (auto& frame : frames) frame.sensor.time = frame.host.time;
  expect_replay(folder / "a.oni", frames);
}

TEST(Recording, NamesWhyItCannotBeWritten) {
  const TemporaryDirectory folder;
  const auto frames = sample_frames(16, 12, 1);
  const auto error_of = [&](const std::filesystem::path& path, const RecordingFacts& facts) {
    const auto recorder = Recorder::create(path, facts);
    return recorder ? std::string() : recorder.error().message;
  };
  RecordingFacts facts{frames[0].intrinsics, 30, "test"};
  EXPECT_NE(error_of(folder / "none/a.oni", facts).find("none/a.oni: cannot be written: No such file"),
            std::string::npos);
  facts.intrinsics.width = 0;
  EXPECT_NE(error_of(folder / "a.oni", facts).find("resolution 0 x 12"), std::string::npos);
  facts.intrinsics.width = facts.intrinsics.height = 2000;
  EXPECT_NE(error_of(folder / "a.oni", facts).find("resolution 2000 x 2000"), std::string::npos);
  facts.intrinsics = frames[0].intrinsics;
  facts.intrinsics.focal_x_px = 0;
  EXPECT_NE(error_of(folder / "a.oni", facts).find("focal_x_px: expected a number"), std::string::npos);
}

TEST(Replay, NamesWhatIsWrongWithAFile) {
  const TemporaryDirectory folder;
  EXPECT_NE(open_error(folder / "none.oni").find("none.oni: cannot be opened: No such file"), std::string::npos);
  EXPECT_NE(open_error(folder.path()).find("not a regular file"), std::string::npos);
  write(folder / "a.oni", "");
  EXPECT_NE(open_error(folder / "a.oni").find("a.oni: not an ONI recording: the file is empty"), std::string::npos);
  record(folder / "a.oni", sample_frames(16, 12, 3));
  std::filesystem::resize_file(folder / "a.oni", std::filesystem::file_size(folder / "a.oni") - 1);
  EXPECT_NE(open_error(folder / "a.oni").find("a.oni: truncated recording"), std::string::npos);
  test::OniBytes zero;
  zero.depth_stream(0, 0, 1).frame(1, 0, "x").end();
  write(folder / "zero.oni", zero.bytes);
  EXPECT_NE(open_error(folder / "zero.oni").find("zero.oni: resolution 0 x 0"), std::string::npos);
  EXPECT_EQ(open_depth_source("kinect:0").error().message,
            "source 'kinect:0': expected oni:FILE, fakenect:DIR, openni2:, freenect:N or v4l2:/dev/videoN");
  EXPECT_EQ(open_depth_source("oni:").error().message, "source 'oni:': expected a path after the colon");
}

TEST(Replay, StopsAtACorruptImageAndSaysWhere) {
  const TemporaryDirectory folder;
  test::OniBytes file;
  file.depth_stream(4, 2, 3, "16zT");
  const std::string flat = std::string("\x01\x00\xe8\x03\x00\x00\xe3", 7) + '\x6d';  // 8 pixels of 1000
  file.frame(1, 0, flat).frame(2, 33333, flat).frame(3, 66666, flat.substr(0, 6)).end();
  write(folder / "a.oni", file.bytes);
  const auto source = replay(folder / "a.oni");
  ASSERT_TRUE(source);
  DepthFrame frame;
  ASSERT_EQ(source->read(frame, 1s).value(), ReadStatus::Frame);
  EXPECT_EQ(frame.depth_mm, std::vector<std::uint16_t>(8, 1000));
  const auto broken = source->read(frame, 1s);
  ASSERT_FALSE(broken);
  EXPECT_NE(broken.error().message.find("a.oni: image 3 at byte "), std::string::npos) << broken.error().message;
}

TEST(Replay, SurvivesFlippedBytes) {
  const TemporaryDirectory folder;
  record(folder / "a.oni", sample_frames(24, 16, 3));
  std::ifstream whole_file(folder / "a.oni", std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(whole_file), {}};
  std::filesystem::remove(folder / "a.oni.toml");
  const char* rounds = std::getenv("ARMATURE_TEST_ROUNDS");
  std::mt19937 random(7);
  for (int round = 0; round < (rounds != nullptr ? std::atoi(rounds) : 40); ++round) {
    std::string broken = whole;
    for (unsigned flips = 1 + random() % 3; flips > 0; --flips) {
      // Half of the flips into the headers, which most bytes are not.
      const std::size_t at = random() % (random() % 2 == 0 ? 1500 : broken.size());
      broken[at] = static_cast<char>(random());
    }
    write(folder / "b.oni", broken);
    auto source = open_depth_source("oni:" + (folder / "b.oni").string());
    if (!source) {
      EXPECT_EQ(source.error().message.find('\n'), std::string::npos);
      continue;
    }
    DepthFrame frame;
    for (int reads = 0;; ++reads) {
      ASSERT_LE(reads, 3);
      const auto status = (*source)->read(frame, 1s);
      if (!status || *status == ReadStatus::EndOfStream) break;
    }
  }
}

TEST(Replay, IsSilent) {
  const TemporaryDirectory folder;
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const auto frames = sample_frames(16, 12, 2);
  record(folder / "a.oni", frames);
  expect_replay(folder / "a.oni", frames);
  write(folder / "b.oni", "NI10 and no more");
  const std::string refused = open_error(folder / "b.oni");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_NE(refused, "");
}

}  // namespace
}  // namespace armature
