// Synthetic people in furnished rooms with a sensor's noise, and real recordings where they are at hand.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "firmware_host/recording/import.h"
#include "tracker/segmentation/segmenter.h"
#include "tracker/synth/synth_source.h"

namespace armature {
namespace {

/// How one person of a script was segmented, over the frames in which half of her or more was to be seen.
struct Score {
  std::size_t frames = 0;
  std::size_t found = 0;  ///< frames in which a user covers her with an intersection over union above 0.5
  float median = 0;       ///< intersection over union
};

Score play(const std::string& uri, std::uint8_t who) {
  auto source = SynthSource::open(uri);
  EXPECT_TRUE(source.has_value());
  if (!source) return {};
  struct Seen {
    float area;
    float overlap;
  };
  std::vector<Seen> seen;
  Segmenter segmenter({});
  DepthFrame frame;
  for (;;) {
    const auto status = (*source)->read(frame, std::chrono::milliseconds(0));
    if (!status || *status != ReadStatus::Frame) break;
    const Segmentation& result = segmenter.process(frame.view());
    const auto owner = (*source)->truth().owner;
    const float per_pixel = 1e-3F / static_cast<float>(frame.intrinsics.focal_x_px);
    Seen now{0, 0};
    std::size_t pixels = 0;
    std::array<std::size_t, 256> inside{};
    std::array<std::size_t, 256> all{};
    for (std::size_t i = 0; i < owner.size(); ++i) {
      ++all[result.user_of_pixel[i]];
      if (owner[i] != who || frame.depth_mm[i] == 0) continue;
      ++pixels;
      ++inside[result.user_of_pixel[i]];
      const float side = static_cast<float>(frame.depth_mm[i]) * per_pixel;
      now.area += side * side;
    }
    if (pixels == 0) continue;
    for (const User& user : result.users) {
      const auto either = static_cast<float>(pixels + all[user.id] - inside[user.id]);
      now.overlap = std::max(now.overlap, static_cast<float>(inside[user.id]) / either);
    }
    seen.push_back(now);
  }
  if (seen.empty()) return {};
  std::ranges::sort(seen, {}, &Seen::area);
  const float whole = seen[seen.size() * 9 / 10].area;
  std::erase_if(seen, [whole](const Seen& s) { return s.area < whole / 2; });
  std::ranges::sort(seen, {}, &Seen::overlap);
  return {seen.size(),
          static_cast<std::size_t>(std::ranges::count_if(seen, [](const Seen& s) { return s.overlap > 0.5F; })),
          seen[seen.size() / 2].overlap};
}

class SegmenterScenes : public testing::TestWithParam<std::string> {};

TEST_P(SegmenterScenes, FindTheUserInNinetyNineFramesOfAHundred) {
  const Score score = play(GetParam(), 1);
  EXPECT_GE(score.median, 0.95F);
  EXPECT_GE(score.found * 100, score.frames * 99) << score.found << " of " << score.frames;
}

INSTANTIATE_TEST_SUITE_P(Scripts, SegmenterScenes,
                         testing::Values("walk_in?size=320x240&fps=15&seed=1", "leave?size=320x240&fps=15&seed=2",
                                         "second_person?size=320x240&fps=15&seed=3",
                                         "stand?size=320x240&fps=5&seed=5&distance=3.6"));

/// Little-endian millimetres, whatever comes before the last width x height values.
DepthFrame read_raw(const std::filesystem::path& path, const Intrinsics& intrinsics) {
  DepthFrame frame;
  frame.intrinsics = intrinsics;
  frame.depth_mm.resize(static_cast<std::size_t>(intrinsics.width) * static_cast<std::size_t>(intrinsics.height));
  std::ifstream file(path, std::ios::binary);
  const auto bytes = static_cast<std::streamoff>(frame.depth_mm.size() * 2);
  file.seekg(-bytes, std::ios::end);
  for (std::uint16_t& mm : frame.depth_mm) {
    const int low = file.get();
    mm = static_cast<std::uint16_t>(low | file.get() << 8);
  }
  return frame;
}

constexpr Intrinsics kKinect{640, 480, 525, 525, 319.5, 239.5};
const std::filesystem::path kStills = "../shared/data/depth/still";

TEST(SegmenterOnRealData, FindsFivePeopleInACorridor) {
  const auto path = kStills / "five_people_z.npy";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const DepthFrame frame = read_raw(path, kKinect);
  Segmenter segmenter({});
  const Segmentation& result = segmenter.process(frame.view());
  EXPECT_EQ(result.users.size(), 5U);
  ASSERT_TRUE(result.floor.has_value());
  EXPECT_NEAR(result.floor->offset, 1.3F, 0.1F);
}

TEST(SegmenterOnRealData, FindsUpperBodiesThatAreNear) {
  const auto folder = kStills / "skeltrack";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here";
  const std::set<std::string> with_two = {"depth-data-1399145206", "depth-data-82823944"};
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const DepthFrame frame = read_raw(entry.path(), kKinect);
    Segmenter segmenter({});
    const Segmentation& result = segmenter.process(frame.view());
    EXPECT_EQ(result.users.size(), with_two.contains(entry.path().filename().string()) ? 2U : 1U) << entry.path();
    EXPECT_FALSE(result.floor.has_value()) << entry.path();
  }
}

TEST(SegmenterOnRealData, WhereTheBackgroundIsRemovedThereIsOneUserThroughout) {
  const std::filesystem::path folder = "../shared/data/depth/utd";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here";
  int frames = 0;
  int with_one = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".zst") continue;
    auto source = open_raw_depth(entry.path(), {nominal_intrinsics(320, 240), 30});
    ASSERT_TRUE(source.has_value()) << source.error().message;
    Segmenter segmenter({});
    DepthFrame frame;
    for (;;) {
      const auto status = (*source)->read(frame, std::chrono::milliseconds(0));
      ASSERT_TRUE(status.has_value()) << status.error().message;
      if (*status != ReadStatus::Frame) break;
      const Segmentation& result = segmenter.process(frame.view());
      ++frames;
      with_one += result.users.size() == 1 && result.users[0].id == 1;
      ASSERT_FALSE(result.floor.has_value()) << entry.path();
    }
  }
  EXPECT_EQ(frames, 6925);
  EXPECT_GE(with_one * 100, frames * 99) << with_one << " of " << frames;
}

}  // namespace
}  // namespace armature
