#include "tracker/joints/joint_estimator.h"

#include <gtest/gtest.h>

#include "tests/support/count_allocations.h"
#include "tests/tracker/forest/paper_doll.h"
#include "tracker/joints/vote_cloud.h"

namespace armature {
namespace {

class PaperTracker {
 public:
  explicit PaperTracker(const Intrinsics& intrinsics) : classifier_(forest()), estimator_(forest()) {
    classifier_.reset(intrinsics);
  }
  Skeleton track(const TrainingImage& image, std::span<const std::uint8_t> mask) {
    Skeleton skeleton;
    estimator_.estimate(
        classifier_.classify({.depth_mm = image.depth_mm, .intrinsics = image.intrinsics, .sensor = {}, .host = {}},
                             mask, 1),
        skeleton);
    return skeleton;
  }
  Skeleton track(const PaperDoll& doll) {
    const TrainingImage image = paper_image(doll, qvga());
    return track(image, image.user);
  }
  JointEstimator& estimator() { return estimator_; }

 private:
  static std::shared_ptr<const Forest> forest() {
    static const auto trained = std::make_shared<const Forest>(*train_forest(paper_training(), paper_images(), {}, {}));
    return trained;
  }
  PartClassifier classifier_;
  JointEstimator estimator_;
};

constexpr std::array kPaperJoints = {JointId::Head,     JointId::Neck,      JointId::LeftThigh, JointId::RightThigh,
                                     JointId::LeftFoot, JointId::RightFoot, JointId::Waist};

TEST(JointEstimator, FindsTheJointsOfAPaperDollWithinThreeCentimetres) {
  PaperTracker tracker(qvga());
  for (int i = 2000; i < 2010; ++i) {
    const PaperDoll doll = paper_doll(i);
    tracker.estimator().reset();
    const Skeleton skeleton = tracker.track(doll);
    for (const JointId joint : kPaperJoints) {
      EXPECT_EQ(skeleton[joint].state, JointState::Observed) << kJointNames[index(joint)] << " of doll " << i;
      EXPECT_LT((skeleton[joint].position - paper_joint(doll, joint)).norm(), 0.03F)
          << kJointNames[index(joint)] << " of doll " << i;
      EXPECT_GT(skeleton[joint].confidence, 0.25F);
      EXPECT_LE(skeleton[joint].confidence, 1.0F);
    }
  }
}

TEST(JointEstimator, TheUserPositionIsTheMiddleOfTheTorsoWhateverTheArmsDo) {
  PaperTracker tracker(qvga());
  const PaperDoll doll{.x_m = 0.2F, .top_m = -0.8F, .z_m = 2.6F};
  const Skeleton skeleton = tracker.track(doll);
  EXPECT_NEAR(skeleton.user_position.x(), 0.2F, 0.02F);
  EXPECT_NEAR(skeleton.user_position.y(), -0.8F + 0.56F, 0.04F);
  EXPECT_NEAR(skeleton.user_position.z(), 2.6F, 0.001F);
}

TEST(JointEstimator, AJointThatIsHiddenMovesAlongWithItsNeighbourUntilItIsLost) {
  const auto leaf_for = [](JointId joint) {
    Leaf leaf;
    leaf.votes[0].joint = static_cast<std::uint8_t>(index(joint));
    return leaf;
  };
  const Leaf knee = leaf_for(JointId::LeftKnee);
  const Leaf ankle = leaf_for(JointId::LeftAnkle);
  const auto pixel = [](const Leaf& leaf, float x, float y) {
    return ClassifiedPixel{.point = {x, y, 2}, .area_m2 = 0.01F, .leaves = {&leaf}};
  };
  Tree stump;
  stump.leaves.resize(1);
  JointEstimator estimator(std::make_shared<const Forest>(*Forest::create({stump}, "")), {.hold_frames = 2});
  Skeleton skeleton;
  const std::array both = {pixel(knee, 0, 0.2F), pixel(ankle, 0.05F, 0.6F)};
  estimator.estimate({both}, skeleton);
  EXPECT_EQ(skeleton[JointId::LeftAnkle].state, JointState::Observed);

  const std::array moved = {pixel(knee, 0.1F, 0.2F)};
  for (int frame = 0; frame < 2; ++frame) {
    estimator.estimate({moved}, skeleton);
    EXPECT_EQ(skeleton[JointId::LeftKnee].state, JointState::Observed);
    EXPECT_EQ(skeleton[JointId::LeftAnkle].state, JointState::Inferred);
    EXPECT_EQ(skeleton[JointId::LeftAnkle].confidence, 0.0F);
    EXPECT_LT((skeleton[JointId::LeftAnkle].position - Eigen::Vector3f(0.15F, 0.6F, 2)).norm(), 0.001F);
  }
  estimator.estimate({moved}, skeleton);
  EXPECT_EQ(skeleton[JointId::LeftAnkle].state, JointState::Lost);
}

TEST(JointEstimator, TheBuildFollowsUntilItIsKept) {
  // Leaves vote for head and hips; the correction moves the head, which nothing else moves, up by their width at rest.
  constexpr std::size_t kHipsAtRest = 4 * kJointCount + 2 + 3 * index(JointId::RightHip);  // from right to left, x
  Leaf head, left, right;
  head.votes[0].joint = static_cast<std::uint8_t>(index(JointId::Head));
  left.votes[0].joint = static_cast<std::uint8_t>(index(JointId::LeftHip));
  right.votes[0].joint = static_cast<std::uint8_t>(index(JointId::RightHip));
  PerceptronLayer layer{.inputs = kCorrectionInputs,
                        .outputs = kCorrectionOutputs,
                        .weights = std::vector<float>(std::size_t{kCorrectionInputs} * kCorrectionOutputs),
                        .bias = std::vector<float>(kCorrectionOutputs)};
  layer.weights[kHipsAtRest * kCorrectionOutputs + 3 * index(JointId::Head) + 1] = -1;
  Tree stump;
  stump.leaves.resize(1);
  JointEstimator estimator(std::make_shared<const Forest>(
      *Forest::create({stump}, "")->corrected_by(*Perceptron::create({std::move(layer)}))));
  const auto raised = [&](float half_width) {
    const auto pixel = [](const Leaf& leaf, float x, float y) {
      return ClassifiedPixel{.point = {x, y, 2}, .area_m2 = 0.01F, .leaves = {&leaf}};
    };
    const std::array all = {pixel(head, 0, -0.5F), pixel(left, half_width, 0.2F), pixel(right, -half_width, 0.2F)};
    Skeleton skeleton;
    estimator.estimate({all}, skeleton);
    EXPECT_NEAR(estimator.voted()[JointId::Head].position.y(), -0.5F, 1e-4) << "as it was before";
    return -0.5F - skeleton[JointId::Head].position.y();
  };
  EXPECT_NEAR(raised(0.10F), 0.20F, 1e-4);
  EXPECT_NEAR(raised(0.20F), 0.30F, 1e-4);  // the mean of both
  estimator.keep_build(true);
  EXPECT_NEAR(raised(0.60F), 0.60F, 1e-4) << "two frames are too few to be kept";
  for (int frame = 3; frame < 15; ++frame) (void)raised(0.30F);
  const float kept = raised(0.30F);
  EXPECT_NEAR(raised(0.10F), kept, 1e-4);
  estimator.reset();
  EXPECT_NEAR(raised(0.10F), 0.20F, 1e-4);  // somebody else
}

TEST(JointEstimator, AJointStaysWhereItWasForAFewVotesMore) {
  Leaf knee;
  knee.votes[0].joint = static_cast<std::uint8_t>(index(JointId::LeftKnee));
  Tree stump;
  stump.leaves.resize(1);
  JointEstimator estimator(std::make_shared<const Forest>(*Forest::create({stump}, "")));
  const auto knee_of = [&](float here_m2, float there_m2) {
    const std::array pixels = {ClassifiedPixel{.point = {0, 0.2F, 2}, .area_m2 = here_m2, .leaves = {&knee}},
                               ClassifiedPixel{.point = {0.5F, 0.2F, 2}, .area_m2 = there_m2, .leaves = {&knee}}};
    Skeleton skeleton;
    estimator.estimate({pixels}, skeleton);
    return skeleton[JointId::LeftKnee].position.x();
  };
  EXPECT_NEAR(knee_of(0.010F, 0.001F), 0, 0.01);
  EXPECT_NEAR(knee_of(0.010F, 0.011F), 0, 0.01);
  EXPECT_NEAR(knee_of(0.010F, 0.020F), 0.5F, 0.01);
}

TEST(JointEstimator, WithNobodyThereEveryJointIsLostWhereItWas) {
  PaperTracker tracker(qvga());
  const PaperDoll doll;
  const Skeleton before = tracker.track(doll);
  const TrainingImage image = paper_image(doll, qvga());
  const std::vector<std::uint8_t> nobody(image.depth_mm.size(), 0);
  const Skeleton after = tracker.track(image, nobody);
  for (std::size_t j = 0; j < kJointCount; ++j) {
    EXPECT_EQ(after.joints[j].state, JointState::Lost);
    EXPECT_EQ(after.joints[j].confidence, 0.0F);
    EXPECT_EQ(after.joints[j].position, before.joints[j].position);
  }
}

TEST(JointEstimator, TheSameFramesGiveTheSameJointsAfterAReset) {
  PaperTracker tracker(qvga());
  const Skeleton first = tracker.track(paper_doll(1));
  (void)tracker.track(paper_doll(2));
  tracker.estimator().reset();
  const Skeleton again = tracker.track(paper_doll(1));
  for (std::size_t j = 0; j < kJointCount; ++j) EXPECT_EQ(first.joints[j].position, again.joints[j].position);
}

TEST(JointEstimator, AFrameAllocatesNothing) {
  PaperTracker tracker(qvga());
  const TrainingImage image = paper_image(paper_doll(3), qvga());
  const auto& mask = image.user;
  (void)tracker.track(image, mask);
  const std::size_t before = test::allocations;
  for (int i = 0; i < 3; ++i) (void)tracker.track(image, mask);
  EXPECT_EQ(test::allocations, before);
}

TEST(VoteCloud, MeanShiftClimbsToTheNearestModeAndLeavesTheOtherAlone) {
  VoteCloud cloud(100);
  for (int i = -5; i <= 5; ++i) {
    cloud.add({0.01F * static_cast<float>(i), 0, 2}, 1);
    cloud.add({1 + 0.01F * static_cast<float>(i), 0, 2}, 2);
  }
  cloud.finish();
  const VoteMode near = cloud.mode_near({0.08F, 0.02F, 2}, 0.2F, 30);
  EXPECT_LT((near.position - Eigen::Vector3f(0, 0, 2)).norm(), 0.002F);
  const VoteMode far = cloud.mode_near({0.9F, 0, 2}, 0.2F, 30);
  EXPECT_LT((far.position - Eigen::Vector3f(1, 0, 2)).norm(), 0.002F);
  EXPECT_NEAR(far.mass, 2 * near.mass, 0.1F);
  EXPECT_NEAR(cloud.total_weight(), 33, 1e-4);
  EXPECT_EQ(cloud.mode_near({5, 5, 5}, 0.2F, 30).mass, 0);
}

}  // namespace
}  // namespace armature
