#include <fstream>

#include <gtest/gtest.h>

#include "firmware_host/backends/freenect.h"
#include "firmware_host/depth_source.h"
#include "tests/support/temporary_directory.h"

namespace armature {
namespace {

using namespace std::chrono_literals;
using test::TemporaryDirectory;

constexpr std::size_t kPixels = 640 * 480;
constexpr const char* kHeader = "P5 640 480 65535\n";

void write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

std::string image(std::uint16_t value, std::uint16_t first) {
  std::vector<std::uint16_t> pixels(kPixels, value);
  pixels[0] = first;
  return kHeader + std::string(reinterpret_cast<const char*>(pixels.data()), 2 * kPixels);
}

std::string open_error(const std::filesystem::path& directory) {
  const auto source = open_depth_source("fakenect:" + directory.string());
  return source ? "" : source.error().message;
}

TEST(Fakenect, ReplaysADumpInOrderAsMillimetres) {
  const TemporaryDirectory folder;
  write(folder / "INDEX.txt",
        "r-1316653600.700000-1.ppm\nd-1316653600.741451-100.pgm\na-1316653600.741500-100.dump\n"
        "d-1316653600.774784-2000100.pgm\n");
  write(folder / "d-1316653600.741451-100.pgm", image(700, 2047));
  write(folder / "d-1316653600.774784-2000100.pgm", image(900, 2047));
  auto source = open_depth_source("fakenect:" + folder.path().string());
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_EQ((*source)->info().frame_count, 2);
  DepthFrame frame;
  ASSERT_EQ((*source)->read(frame, 1s).value(), ReadStatus::Frame);
  EXPECT_EQ(frame.depth_mm[0], 0);
  EXPECT_EQ(frame.depth_mm[1], 887);
  EXPECT_EQ(frame.sensor.time, 0us);
  ASSERT_EQ((*source)->read(frame, 1s).value(), ReadStatus::Frame);
  EXPECT_EQ(frame.depth_mm[1], 1824);
  EXPECT_EQ(frame.sequence, 1U);
  EXPECT_EQ(frame.sensor.time, 33333us);
  EXPECT_EQ((*source)->read(frame, 1s).value(), ReadStatus::EndOfStream);
}

TEST(Fakenect, TakesLargeValuesForMillimetres) {
  const TemporaryDirectory folder;
  write(folder / "INDEX.txt", "d-1.0-1.pgm\n");
  write(folder / "d-1.0-1.pgm", image(700, 3000));
  auto source = open_depth_source("fakenect:" + folder.path().string());
  ASSERT_TRUE(source) << source.error().message;
  DepthFrame frame;
  ASSERT_EQ((*source)->read(frame, 1s).value(), ReadStatus::Frame);
  EXPECT_EQ(frame.depth_mm[0], 3000);
  EXPECT_EQ(frame.depth_mm[1], 700);
}

TEST(Fakenect, ConvertsRawValuesAsLibfreenectDoes) {
  const auto to_mm = kinect_raw_to_mm();
  // 10 (120 + 120 m / (7.5 - m)) with m = 0.1042 ((raw - 800) / 4 - 0.375)
  EXPECT_EQ(to_mm[0], 317);
  EXPECT_EQ(to_mm[800], 1193);
  EXPECT_EQ(to_mm[1000], 3864);
  EXPECT_EQ(to_mm[2047], 0);
  EXPECT_EQ(to_mm[1500], 0);
  for (std::size_t raw = 1; raw < 1000; ++raw) EXPECT_GE(to_mm[raw], to_mm[raw - 1]);
}

TEST(Fakenect, NamesWhatIsWrongWithADump) {
  const TemporaryDirectory folder;
  EXPECT_NE(open_error(folder / "missing").find("INDEX.txt: cannot be opened"), std::string::npos);
  write(folder / "INDEX.txt", "");
  EXPECT_NE(open_error(folder.path()).find("names no depth images"), std::string::npos);
  write(folder / "INDEX.txt", "r-1.0-1.ppm\nd-x-1.pgm\n");
  EXPECT_NE(open_error(folder.path()).find("INDEX.txt:2: expected 'd-SECONDS-TICKS.pgm'"), std::string::npos);
  write(folder / "INDEX.txt", "d-1.0-../../etc/passwd\n");
  EXPECT_NE(open_error(folder.path()).find("without its folder"), std::string::npos);
  write(folder / "INDEX.txt", "d-1.0-1.pgm\n");
  EXPECT_NE(open_error(folder.path()).find("d-1.0-1.pgm: cannot be opened"), std::string::npos);
  const std::string whole = image(700, 2047);
  for (const std::size_t length : {std::size_t{0}, std::size_t{5}, std::size_t{17}, whole.size() - 1}) {
    write(folder / "d-1.0-1.pgm", whole.substr(0, length));
    EXPECT_NE(open_error(folder.path()).find("expected"), std::string::npos) << length;
  }
  write(folder / "d-1.0-1.pgm", "P5 99999 99999 65535\n");
  EXPECT_NE(open_error(folder.path()).find("expected the line 'P5 640 480 65535'"), std::string::npos);
  write(folder / "d-1.0-1.pgm", whole + "x");
  EXPECT_NE(open_error(folder.path()).find("expected 614400"), std::string::npos);
}

TEST(Fakenect, FailsAtTheImageThatIsMissing) {
  const TemporaryDirectory folder;
  write(folder / "INDEX.txt", "d-1.0-1.pgm\nd-2.0-2.pgm\n");
  write(folder / "d-1.0-1.pgm", image(700, 2047));
  auto source = open_depth_source("fakenect:" + folder.path().string());
  ASSERT_TRUE(source) << source.error().message;
  DepthFrame frame;
  ASSERT_EQ((*source)->read(frame, 1s).value(), ReadStatus::Frame);
  const auto second = (*source)->read(frame, 1s);
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().message.find("d-2.0-2.pgm: cannot be opened"), std::string::npos);
}

}  // namespace
}  // namespace armature
