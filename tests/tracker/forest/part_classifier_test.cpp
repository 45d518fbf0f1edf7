#include "tracker/forest/part_classifier.h"

#include <gtest/gtest.h>

#include "tests/tracker/forest/paper_doll.h"

namespace armature {
namespace {

std::shared_ptr<const Forest> paper_forest() {
  static const auto forest = std::make_shared<const Forest>(*train_forest(paper_training(), paper_images(), {}, {}));
  return forest;
}

DepthView view_of(const TrainingImage& image) {
  return {.depth_mm = image.depth_mm, .intrinsics = image.intrinsics, .sensor = {}, .host = {}};
}

double right_share(const Intrinsics& intrinsics, const ClassifierOptions& options) {
  PartClassifier classifier(paper_forest(), options);
  classifier.reset(intrinsics);
  int right = 0, all = 0;
  for (int i = 1000; i < 1010; ++i) {  // dolls that it never saw
    const TrainingImage image = paper_image(paper_doll(i), intrinsics);
    const auto& mask = image.user;
    for (const ClassifiedPixel& pixel : classifier.classify(view_of(image), mask, 1).pixels) {
      ++all;
      if (index(most_likely_part(pixel)) ==
          image.part_of_pixel[pixel.v * static_cast<std::size_t>(intrinsics.width) + pixel.u]) {
        ++right;
      }
    }
  }
  return static_cast<double>(right) / all;
}

TEST(PartClassifier, AForestLearnsThePartsOfAPaperDoll) {
  EXPECT_GT(right_share(qvga(), {.stride = 2}), 0.93);  // the rest are pixels along the borders of parts
}

TEST(PartClassifier, AForestTrainedAt320WorksAt640) {
  EXPECT_GT(right_share(vga(), {}), 0.92);
}

TEST(PartClassifier, SamplesLieOnTheUserAtTheStrideWithTheirPointAndArea) {
  PartClassifier classifier(paper_forest(), {.stride = 3});
  classifier.reset(qvga());
  const TrainingImage image = paper_image({.x_m = 0.1F, .z_m = 2.0F}, qvga());
  const auto& mask = image.user;
  const PartVotes& votes = classifier.classify(view_of(image), mask, 1);
  int expected = 0;
  for (int v = 0; v < 240; v += 3) {
    for (int u = 0; u < 320; u += 3) expected += mask[static_cast<std::size_t>(v * 320 + u)];
  }
  EXPECT_EQ(votes.stride, 3);
  ASSERT_EQ(static_cast<int>(votes.pixels.size()), expected);
  for (const ClassifiedPixel& pixel : votes.pixels) {
    EXPECT_EQ(pixel.u % 3, 0);
    EXPECT_EQ(mask[static_cast<std::size_t>(pixel.v * 320 + pixel.u)], 1);
    EXPECT_NEAR(pixel.point.x(), (pixel.u - 160.0) * 2.0 / 285.0, 1e-5);
    EXPECT_NEAR(pixel.area_m2, 9 * 2.0 * 2.0 / 285.0 / 285.0, 1e-8);
    EXPECT_EQ(pixel.leaves[2], nullptr);
    EXPECT_NE(pixel.leaves[1], nullptr);
  }
}

TEST(PartClassifier, WhatIsNotTheUserDoesNotMatter) {
  PartClassifier classifier(paper_forest());
  classifier.reset(qvga());
  TrainingImage image = paper_image({}, qvga());
  auto mask = image.user;
  const auto before = classifier.classify(view_of(image), mask, 1).pixels;
  const std::vector<ClassifiedPixel> alone(before.begin(), before.end());
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask[i] == 0) {
      image.depth_mm[i] = static_cast<std::uint16_t>(2300 + i % 50);
      mask[i] = i % 3 == 0 ? 2 : 0;
    }
  }
  const auto crowded = classifier.classify(view_of(image), mask, 1).pixels;
  ASSERT_EQ(crowded.size(), alone.size());
  for (std::size_t i = 0; i < alone.size(); ++i) EXPECT_EQ(crowded[i].leaves, alone[i].leaves);
}

TEST(PartClassifier, NobodyAnotherSizeAndAHoleGiveNoPixels) {
  PartClassifier classifier(paper_forest());
  classifier.reset(qvga());
  const TrainingImage image = paper_image({}, qvga());
  const auto& mask = image.user;
  EXPECT_TRUE(classifier.classify(view_of(image), mask, 2).pixels.empty());
  EXPECT_TRUE(classifier.classify(view_of(image), mask, 0).pixels.empty());
  EXPECT_TRUE(classifier.classify(view_of(image), std::span(mask).first(10), 1).pixels.empty());
  const TrainingImage other = paper_image({}, vga());
  const auto& other_mask = other.user;
  EXPECT_TRUE(classifier.classify(view_of(other), other_mask, 1).pixels.empty());

  // A mask over pixels without depth.
  const std::vector<std::uint8_t> everywhere(mask.size(), 1);
  TrainingImage hole = image;
  hole.depth_mm.assign(hole.depth_mm.size(), 0);
  EXPECT_TRUE(classifier.classify(view_of(hole), everywhere, 1).pixels.empty());
}

TEST(PartClassifier, APersonInFrontOfTheLensStaysWithinBounds) {
  PartClassifier classifier(paper_forest(), {.stride = 1});
  classifier.reset(qvga());
  TrainingImage image = paper_image({}, qvga());
  for (std::size_t i = 0; i < image.depth_mm.size(); ++i) image.depth_mm[i] = static_cast<std::uint16_t>(1 + i % 40);
  const std::vector<std::uint8_t> everywhere(image.depth_mm.size(), 1);
  EXPECT_EQ(classifier.classify(view_of(image), everywhere, 1).pixels.size(), image.depth_mm.size());
}

}  // namespace
}  // namespace armature
