#include "firmware_host/recording/import.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>
#include <png.h>
#include <zstd.h>

#include "firmware_host/recording/recorder.h"
#include "tests/firmware_host/sample_frames.h"
#include "tests/support/temporary_directory.h"

namespace armature {
namespace {

using namespace std::chrono_literals;
using test::sample_frames;
using test::TemporaryDirectory;

const std::filesystem::path kUtd = "../shared/data/depth/utd";

std::string pixels_of(const std::vector<DepthFrame>& frames) {
  std::string bytes;
  for (const DepthFrame& frame : frames)
    bytes.append(reinterpret_cast<const char*>(frame.depth_mm.data()), 2 * frame.depth_mm.size());
  return bytes;
}

std::string compressed(const std::string& bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  out.resize(ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 3));
  return out;
}

void write(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

void write_png(const std::filesystem::path& path, const DepthFrame& frame, unsigned format = PNG_FORMAT_LINEAR_Y) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(frame.intrinsics.width);
  image.height = static_cast<png_uint_32>(frame.intrinsics.height);
  image.format = format;
  ASSERT_NE(png_image_write_to_file(&image, path.c_str(), 0, frame.depth_mm.data(), 0, nullptr), 0);
}

/// Everything a source hands out until it ends; the message where it fails.
struct Outcome {
  std::vector<DepthFrame> frames;
  std::string error;
};

Outcome read_all(Expected<std::unique_ptr<DepthSource>> source) {
  if (!source) return {{}, source.error().message};
  Outcome outcome;
  for (;;) {
    DepthFrame frame;
    const auto status = (*source)->read(frame, 1s);
    if (!status) {
      outcome.error = status.error().message;
      return outcome;
    }
    if (*status == ReadStatus::EndOfStream) return outcome;
    outcome.frames.push_back(std::move(frame));
  }
}

TEST(RawImport, ReadsEveryFramePlainAndCompressed) {
  const TemporaryDirectory folder;
  const auto frames = sample_frames(16, 9, 5);
  const std::string bytes = pixels_of(frames);
  write(folder / "a.u16", bytes);
  write(folder / "a.u16.zst", compressed(bytes));
  write(folder / "parts.u16.zst", compressed(bytes.substr(0, 100)) + compressed(bytes.substr(100)));
  const ImportOptions options{nominal_intrinsics(16, 9), 25};
  for (const char* name : {"a.u16", "a.u16.zst", "parts.u16.zst"}) {
    const Outcome outcome = read_all(open_raw_depth(folder / name, options));
    EXPECT_EQ(outcome.error, "") << name;
    EXPECT_EQ(pixels_of(outcome.frames), bytes) << name;
    ASSERT_EQ(outcome.frames.size(), 5U) << name;
    EXPECT_EQ(outcome.frames[4].sensor.time, 160ms) << name;
    EXPECT_EQ(outcome.frames[4].sequence, 4U) << name;
  }
}

TEST(RawImport, RefusesEveryTruncatedPrefix) {
  const TemporaryDirectory folder;
  const std::string bytes = pixels_of(sample_frames(4, 3, 2));
  const std::string packed = compressed(bytes);
  const ImportOptions options{nominal_intrinsics(4, 3), 30};
  for (std::size_t length = 1; length < bytes.size(); ++length) {
    if (length == bytes.size() / 2) continue;  // a whole frame
    write(folder / "a.u16", bytes.substr(0, length));
    EXPECT_NE(read_all(open_raw_depth(folder / "a.u16", options)).error.find("ends within frame"), std::string::npos);
  }
  for (std::size_t length = 1; length < packed.size(); ++length) {
    write(folder / "a.u16.zst", packed.substr(0, length));
    EXPECT_NE(read_all(open_raw_depth(folder / "a.u16.zst", options)).error.find("truncated"), std::string::npos)
        << length;
  }
}

TEST(RawImport, NamesWhatIsWrong) {
  const TemporaryDirectory folder;
  const ImportOptions options{nominal_intrinsics(4, 3), 30};
  EXPECT_NE(read_all(open_raw_depth(folder / "none", options)).error.find("none: cannot be opened"), std::string::npos);
  EXPECT_NE(read_all(open_raw_depth(folder.path(), options)).error.find("not a regular file"), std::string::npos);
  write(folder / "a.u16.zst", "these are not compressed bytes");
  EXPECT_NE(read_all(open_raw_depth(folder / "a.u16.zst", options)).error.find("not zstd"), std::string::npos);
  EXPECT_NE(read_all(open_raw_depth(folder / "a", {nominal_intrinsics(0, 3), 30})).error.find("resolution 0 x 3"),
            std::string::npos);
}

TEST(PngImport, ReadsAFolderInTheOrderOfNames) {
  const TemporaryDirectory folder;
  const auto frames = sample_frames(21, 10, 3);
  write_png(folder / "b.png", frames[1]);
  write_png(folder / "a.png", frames[0]);
  write_png(folder / "c.png", frames[2]);
  write(folder / "notes.txt", "not an image");
  const auto images = list_png_images(folder.path());
  ASSERT_TRUE(images) << images.error().message;
  const Outcome outcome = read_all(open_png_depth(*images, {}));
  EXPECT_EQ(outcome.error, "");
  EXPECT_EQ(pixels_of(outcome.frames), pixels_of(frames));
  ASSERT_FALSE(outcome.frames.empty());
  EXPECT_EQ(outcome.frames[0].intrinsics, nominal_intrinsics(21, 10));
}

TEST(PngImport, NamesWhatIsWrong) {
  const TemporaryDirectory folder;
  EXPECT_NE(list_png_images(folder.path()).error().message.find("holds no .png files"), std::string::npos);
  EXPECT_NE(read_all(open_png_depth({}, {})).error.find("expected at least one"), std::string::npos);
  EXPECT_NE(read_all(open_png_depth({folder / "a.png"}, {})).error.find("cannot be opened"), std::string::npos);
  write(folder / "a.png", "GIF89a");
  EXPECT_NE(read_all(open_png_depth({folder / "a.png"}, {})).error.find("not a PNG image"), std::string::npos);
  const auto frames = sample_frames(32, 8, 1);
  write_png(folder / "a.png", frames[0]);
  write_png(folder / "b.png", sample_frames(8, 8, 1)[0]);
  EXPECT_NE(read_all(open_png_depth({folder / "a.png", folder / "b.png"}, {})).error.find("expected 32 x 8 as before"),
            std::string::npos);
  write_png(folder / "grey8.png", frames[0], PNG_FORMAT_GRAY);
  EXPECT_NE(read_all(open_png_depth({folder / "grey8.png"}, {})).error.find("expected 16-bit grey"), std::string::npos);
  std::ifstream whole_file(folder / "a.png", std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(whole_file), {}};
  for (std::size_t length = 0; length < whole.size(); length += 7) {
    write(folder / "cut.png", whole.substr(0, length));
    EXPECT_NE(read_all(open_png_depth({folder / "cut.png"}, {})).error.find("PNG image"), std::string::npos) << length;
  }
}

// With ARMATURE_TEST_EVERYTHING set: all 108 sequences.
TEST(Import, RecordedPeopleReplayBitForBit) {
  if (!std::filesystem::is_directory(kUtd)) GTEST_SKIP() << kUtd << " is not here";
  std::vector<std::filesystem::path> sequences;
  for (const auto& entry : std::filesystem::directory_iterator(kUtd))
    if (entry.path().extension() == ".zst") sequences.push_back(entry.path());
  std::sort(sequences.begin(), sequences.end());
  if (std::getenv("ARMATURE_TEST_EVERYTHING") == nullptr) sequences = {sequences.front(), sequences.back()};

  std::size_t frames = 0;
  for (const auto& sequence : sequences) {
    const TemporaryDirectory folder;
    const ImportOptions options{nominal_intrinsics(320, 240), 30};
    auto source = open_raw_depth(sequence, options);
    ASSERT_TRUE(source) << source.error().message;
    const auto written = write_recording(folder / "a.oni", **source);
    ASSERT_TRUE(written) << written.error().message;
    const Outcome before = read_all(open_raw_depth(sequence, options));
    const Outcome after = read_all(open_depth_source("oni:" + (folder / "a.oni").string()));
    ASSERT_EQ(after.error, "");
    ASSERT_EQ(after.frames.size(), before.frames.size()) << sequence;
    ASSERT_TRUE(pixels_of(after.frames) == pixels_of(before.frames)) << sequence;
    frames += after.frames.size();
  }
  RecordProperty("frames", static_cast<int>(frames));
  std::printf("%zu sequences, %zu frames replayed bit for bit\n", sequences.size(), frames);
}

}  // namespace
}  // namespace armature
