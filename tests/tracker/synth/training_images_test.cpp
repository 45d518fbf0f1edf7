#include "tracker/synth/training_images.h"

#include <set>

#include <gtest/gtest.h>

namespace armature {
namespace {

TEST(TrainingImages, TheImageDependsOnTheSeedAlone) {
  TrainingSampler a({}), b({});
  LabelledImage first, other, again;
  a.sample(11, first);
  b.sample(12, other);
  b.sample(11, again);
  EXPECT_EQ(first.depth_mm, again.depth_mm);
  EXPECT_EQ(first.part, again.part);
  EXPECT_EQ(first.user, again.user);
  EXPECT_NE(first.depth_mm, other.depth_mm);
  for (std::size_t j = 0; j < kJointCount; ++j) EXPECT_EQ(first.joints[j], again.joints[j]);
}

TEST(TrainingImages, PartsLieOnUserPixelsWithDepth) {
  TrainingSampler sampler({});
  LabelledImage image;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    sampler.sample(seed, image);
    int labelled = 0;
    for (std::size_t pixel = 0; pixel < image.part.size(); ++pixel) {
      if (image.part[pixel] == kNoPart) continue;
      ++labelled;
      EXPECT_LT(image.part[pixel], kPartCount);
      EXPECT_EQ(image.user[pixel], 1);
      EXPECT_NE(image.depth_mm[pixel], 0);
    }
    EXPECT_EQ(labelled, image.person_pixels);
    EXPECT_GT(labelled, 300);
  }
}

TEST(TrainingImages, AllPartsAndAllActivitiesOccur) {
  TrainingSampler sampler({});
  LabelledImage image;
  std::array<long, kPartCount> pixels{};
  std::set<Activity> activities;
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    sampler.sample(seed, image);
    activities.insert(image.activity);
    for (const std::uint8_t part : image.part) {
      if (part != kNoPart) ++pixels[part];
    }
  }
  for (const long count : pixels) EXPECT_GT(count, 150 * 5);
  EXPECT_EQ(activities.size(), kActivityNames.size());
}

TEST(TrainingImages, AtRestThereIsTheSamePersonBeforeTheSameCamera) {
  TrainingSampler sampler{TrainingOptions{}};
  LabelledImage alone, moving, at_rest;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    sampler.sample(seed, alone);
    sampler.sample(seed, moving, &at_rest);
    EXPECT_EQ(alone.depth_mm, moving.depth_mm);  // asking for more changes nothing
    EXPECT_EQ(at_rest.intrinsics, moving.intrinsics);
    const auto length = [](const LabelledImage& image, JointId from, JointId to) {
      return (image.joints[index(to)] - image.joints[index(from)]).norm();
    };
    EXPECT_NEAR(length(at_rest, JointId::LeftHip, JointId::RightHip),
                length(moving, JointId::LeftHip, JointId::RightHip), 1e-4)
        << seed;
    EXPECT_NEAR(length(at_rest, JointId::LeftElbow, JointId::LeftWrist),
                length(moving, JointId::LeftElbow, JointId::LeftWrist), 1e-4)
        << seed;
    EXPECT_TRUE(at_rest.activity == Activity::Stand || at_rest.activity == Activity::Sit);
  }
}

TEST(TrainingImages, LabelledPixelsLieNearTheirJoints) {
  // A part's pixels lie within a limb's length of the joint of its name.
  TrainingSampler sampler({});
  LabelledImage image;
  for (std::uint64_t seed = 200; seed < 220; ++seed) {
    sampler.sample(seed, image);
    const Intrinsics& k = image.intrinsics;
    const Eigen::Vector3f knee = image.joints[index(JointId::LeftKnee)];
    for (int v = 0; v < k.height; ++v) {
      for (int u = 0; u < k.width; ++u) {
        const auto pixel = static_cast<std::size_t>(v * k.width + u);
        if (image.part[pixel] != static_cast<std::uint8_t>(PartLabel::LeftKnee)) continue;
        const double z = image.depth_mm[pixel] * 1e-3;
        const Eigen::Vector3d point{(u - k.centre_x_px) / k.focal_x_px * z, (v - k.centre_y_px) / k.focal_y_px * z, z};
        EXPECT_LT((point.cast<float>() - knee).norm(), 0.30F) << "seed " << seed;
      }
    }
  }
}

}  // namespace
}  // namespace armature
