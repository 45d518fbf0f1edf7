#include "tracker/joints/correction_trainer.h"

#include <gtest/gtest.h>

#include "tests/tracker/forest/paper_doll.h"
#include "tracker/joints/joint_correction.h"
#include "tracker/joints/joint_estimator.h"

namespace armature {
namespace {

/// Where the trees think the waist is; the truth that the correction learns from lies elsewhere.
const Eigen::Vector3f kElsewhere(0, -0.06F, 0.02F);

TrainingImage moved_image(int i) {
  TrainingImage image = paper_image(paper_doll(i), qvga());
  image.joints[index(JointId::Waist)] += kElsewhere;
  return image;
}

/// A doll has one pose.
PersonTwice moved_doll(int i) {
  return {moved_image(i), moved_image(i)};
}

const Forest& trees() {
  static const Forest trained = *train_forest(paper_training(), paper_images(), {}, {});
  return trained;
}

const CorrectionOptions kQuick{
    .image_count = 150, .network = {.hidden = {16}, .epochs = 60, .batch = 16, .step = 5e-3F, .input_noise = 0.02F}};

Eigen::Vector3f waist_of(const Forest& forest, const TrainingImage& image) {
  const auto shared = std::make_shared<const Forest>(forest);
  PartClassifier classifier(shared);
  JointEstimator estimator(shared);
  classifier.reset(image.intrinsics);
  Skeleton skeleton;
  estimator.estimate(
      classifier.classify({.depth_mm = image.depth_mm, .intrinsics = image.intrinsics, .sensor = {}, .host = {}},
                          image.user, 1),
      skeleton);
  return skeleton[JointId::Waist].position;
}

TEST(LearnCorrection, PutsAJointWhereItProvedToBe) {
  double last = 0;
  const auto corrected =
      learn_correction(trees(), moved_doll, kQuick, [&](double share) { last = std::max(last, share); }, {});
  ASSERT_TRUE(corrected) << corrected.error().message;
  EXPECT_EQ(last, 1);
  for (int i = 1000; i < 1005; ++i) {
    const TrainingImage image = moved_image(i);
    const Eigen::Vector3f truth = image.joints[index(JointId::Waist)];
    EXPECT_GT((waist_of(trees(), image) - truth).norm(), 0.05F) << i;
    EXPECT_LT((waist_of(*corrected, image) - truth).norm(), 0.025F) << i;
  }
}

TEST(LearnCorrection, TheSameImagesGiveTheSameForestWithAnyNumberOfThreads) {
  const auto learned = [](int threads) {
    CorrectionOptions options = kQuick;
    options.image_count = 20;
    options.threads = threads;
    return learn_correction(trees(), moved_doll, options, [](double) {}, {})->serialize();
  };
  EXPECT_EQ(learned(1), learned(3));
}

TEST(LearnCorrection, NobodyToLearnFromIsAnError) {
  const auto nobody = [](int i) {
    PersonTwice person = moved_doll(i);
    std::ranges::fill(person.image.user, std::uint8_t{0});
    return person;
  };
  const auto corrected = learn_correction(trees(), nobody, kQuick, [](double) {}, {});
  ASSERT_FALSE(corrected);
  EXPECT_EQ(corrected.error().message, "training: no example to learn offsets from");
}

}  // namespace
}  // namespace armature
