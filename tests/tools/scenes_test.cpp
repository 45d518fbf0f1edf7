// What the skeleton is measured on stays what it is.
#include "tools/evaluation/scenes.h"

#include <fstream>
#include <iterator>
#include <set>

#include <gtest/gtest.h>

#include "tools/evaluation/forest_evaluation.h"
#include "tracker/forest/checksum.h"
#include "tracker/installation.h"
#include "tracker/synth/training_images.h"

namespace armature::tools {
namespace {

using namespace std::chrono_literals;

const std::filesystem::path kFile = "tools/evaluation/scenes/skeleton.txt";

std::vector<Scene> all_scenes() {
  auto scenes = read_scenes(kFile);
  EXPECT_TRUE(scenes) << (scenes ? "" : scenes.error().message);
  return scenes ? *scenes : std::vector<Scene>{};
}

std::string contents(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

template <class T>
std::uint32_t crc32_of(const T& values) {
  return crc32(std::as_bytes(std::span(values)));
}

TEST(Scenes, TheFileIsTheOneThatFiguresArePublishedFor) {
  EXPECT_EQ(crc32_of(contents(kFile)), 0x1613DF84U) << "frozen: add another file rather than change this one";
  EXPECT_EQ(contents(kFile), contents(installed_file("skeleton_scenes.txt")));
}

TEST(Scenes, TheyRenderToTheSameBytes) {
  std::vector<std::uint32_t> sums;
  for (Scene scene : all_scenes()) {
    scene.synth.fps = 2;
    const auto source = open_scene(scene, 80, 60);
    ASSERT_TRUE(source) << source.error().message;
    DepthFrame frame;
    while (*(*source)->read(frame, 0ms) == ReadStatus::Frame) {
      sums.push_back(crc32_of(frame.depth_mm));
      sums.push_back(crc32_of((*source)->truth().part));
    }
  }
  EXPECT_EQ(crc32_of(sums), 0x41530CC2U) << "something changed how synthetic people look: published figures are void";
}

TEST(Scenes, EveryCategoryHasSeveralOverDistancesAndTurns) {
  std::map<std::string, std::vector<Scene>> by_category;
  for (const Scene& scene : all_scenes()) by_category[scene.category].push_back(scene);
  EXPECT_EQ(by_category.size(), 20U);
  for (const auto& [category, scenes] : by_category) {
    EXPECT_GE(scenes.size(), 6U) << category;
    double nearest = 9, farthest = 0, left = 0, right = 0;
    for (const Scene& scene : scenes) {
      nearest = std::min(nearest, scene.synth.distance_m);
      farthest = std::max(farthest, scene.synth.distance_m);
      left = std::max(left, scene.synth.turned_deg);
      right = std::max(right, -scene.synth.turned_deg);
    }
    EXPECT_GE(farthest - nearest, 0.8) << category;
    EXPECT_GE(std::min(left, right), 25) << category;
  }
}

TEST(Scenes, NoTrainingImageIsDrawnFromTheirSeeds) {
  for (const std::uint64_t run : {0ULL, 1ULL, 0xFFFFFFFFULL, ~0ULL}) {
    EXPECT_EQ(training_seed(run, 0xFFFFFFFFULL) & kHeldOut, 0U);
  }
  for (const Scene& scene : all_scenes()) EXPECT_NE(scene.synth.seed & kHeldOut, 0U);
  // Even who asks for one gets somebody else.
  TrainingSampler sampler({.width = 64, .height = 48, .sensor = {}});
  LabelledImage asked, given;
  sampler.sample(7 | kHeldOut, asked);
  sampler.sample(7, given);
  EXPECT_EQ(asked.depth_mm, given.depth_mm);
}

TEST(Scenes, TheUserIsAsTheLineSays) {
  std::set<std::string> seen;
  for (const Scene& scene : all_scenes()) {
    const auto source = open_scene(scene, 32, 24);
    ASSERT_TRUE(source);
    const Person& user = (*source)->user();
    EXPECT_TRUE(scene.synth.wish.fulfilled_by(user)) << scene.number;
    EXPECT_EQ(user.outfit.bag, scene.synth.carry) << scene.number;
    EXPECT_EQ((*source)->script().actors.size(), scene.company == Company::None ? 1U : 2U);
    EXPECT_EQ((*source)->info().frame_count, 90);
  }
}

TEST(Scenes, TheFirstSecondIsRest) {
  for (Scene scene : first_of_each_category(all_scenes())) {
    scene.synth.fps = 10;
    const auto source = open_scene(scene, 32, 24);
    ASSERT_TRUE(source);
    DepthFrame frame;
    while (*(*source)->read(frame, 0ms) == ReadStatus::Frame && frame.sensor.time <= 1s) {
      for (std::size_t m = 0; m < kMotionCount; ++m) {
        EXPECT_LT(std::abs((*source)->truth().normalized[m]), 0.1F) << scene.category << " " << kMotionNames[m];
      }
    }
  }
}

TEST(Scenes, AWrongLineIsNamedWithItsColumn) {
  const auto path = std::filesystem::path(testing::TempDir()) / "scenes.txt";
  const auto said = [&](const std::string& line) {
    std::ofstream(path) << "# scenes\n" << line << "\n";
    const auto scenes = read_scenes(path);
    return scenes ? std::string() : scenes.error().message;
  };
  const std::string good = "arms wave 3 stands adult 1.0 plain 2.0 -10 bare 0.3b mug alone";
  EXPECT_EQ(said(good), "");
  const auto with = [&](const std::string& from, const std::string& to) {
    return said(std::string(good).replace(good.find(from), from.size(), to));
  };
  EXPECT_NE(with("wave", "sing").find(":2: activity 'sing'"), std::string::npos) << with("wave", "sing");
  EXPECT_NE(with("wave", "sing").find("expected one of any_arms, "), std::string::npos) << with("wave", "sing");
  EXPECT_NE(with(" 3 ", " 1.5 ").find("number '1.5': expected a whole number from 1 to"), std::string::npos);
  EXPECT_NE(with("2.0", "9").find("distance '9'"), std::string::npos);
  EXPECT_NE(with("0.3b", "0.9b").find("hidden '0.9b'"), std::string::npos);
  EXPECT_NE(with("mug", "piano").find("carries 'piano'"), std::string::npos);
  EXPECT_NE(with(" alone", "").find("company ''"), std::string::npos);
  EXPECT_NE(with("alone", "alone alone").find("end of the line 'alone'"), std::string::npos);
  EXPECT_NE(said(good + "\n" + good).find(":3: number '3'"), std::string::npos);
  EXPECT_NE(said("").find("holds no scene"), std::string::npos);
}

}  // namespace
}  // namespace armature::tools
