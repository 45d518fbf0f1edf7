// How the skeleton is measured: on records made by hand, and end to end on two of the frozen scenes.
#include <gtest/gtest.h>

#include "tools/evaluation/paper_tracker.h"
#include "tools/evaluation/real_evaluation.h"
#include "tools/evaluation/skeleton_summary.h"
#include "tools/evaluation/utd_sequence.h"
#include "tracker/installation.h"

namespace armature::tools {
namespace {

using enum JointId;

std::shared_ptr<const Forest> installed_forest() {
  static const auto kForest = [] {
    auto forest = Forest::load(installed_model());
    if (!forest) throw std::runtime_error(forest.error().message);
    return std::make_shared<const Forest>(std::move(*forest));
  }();
  return kForest;
}

std::vector<Scene> scenes_of(const std::string& category, std::size_t count) {
  auto scenes = read_scenes(installed_file("skeleton_scenes.txt"));
  if (!scenes) throw std::runtime_error(scenes.error().message);
  std::erase_if(*scenes, [&](const Scene& scene) { return scene.category != category; });
  scenes->resize(std::min(count, scenes->size()));
  return *scenes;
}

TEST(SkeletonSummary, AJointWithoutAPositionIsNotFoundAndHasNoError) {
  Scene scene;
  scene.category = "any";
  SceneRecord record;
  record.systems[0].joints = {
      {.joint = Head, .given = true, .distance_m = 2, .error_m = 0.02F, .confidence = 0.9F},
      {.joint = Head, .given = true, .distance_m = 2, .error_m = 0.30F, .confidence = 0.1F},
      {.joint = Head, .given = false, .distance_m = 2, .error_m = 0, .confidence = 0},
      {.joint = Head, .given = true, .distance_m = 3, .error_m = 0.04F, .confidence = 0.8F},
  };
  const SkeletonSummary summary = summarise({scene}, {{record}}, System::Whole);
  EXPECT_NEAR(summary.joints[index(Head)].average_precision, 0.5, 1e-9);  // two of four, both before the wrong one
  EXPECT_NEAR(summary.joints[index(Head)].mean_error_m, 0.12, 1e-6);
  EXPECT_NEAR(summary.joints_given, 0.75, 1e-9);
  EXPECT_NEAR(summary.navigation.average_precision, 0.5, 1e-9) << "joints that were never in view do not count";

  const auto rows = by_distance(std::vector{record}, System::Whole);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].near_m, 2.0);
  EXPECT_EQ(rows[0].samples, 3U);
  EXPECT_NEAR(rows[1].navigation.mean_error_m, 0.04, 1e-6);
}

TEST(SkeletonSummary, MotionsRestAndSwapsAddUpOverTheScenesThatAreWanted) {
  std::vector<Scene> scenes(2);
  scenes[0].category = "a";
  scenes[1].category = "b";
  std::vector<SceneRecord> records(2);
  for (SceneRecord& record : records) {
    SystemRecord& whole = record.systems[0];
    whole.frames = 10;
    whole.tracked = 9;
    whole.rest_frames = 8;
    whole.standing = 6;
    whole.swaps = 1;
    whole.motions = {{MotionId::Step, radians(2)}, {MotionId::LeanBust, radians(4)}};
  }
  const SkeletonSummary both = summarise(scenes, records, System::Whole);
  EXPECT_EQ(both.scenes, 2);
  EXPECT_EQ(both.swaps, 2);
  EXPECT_NEAR(both.frames_tracked, 0.9, 1e-9);
  EXPECT_NEAR(both.at_rest, 0.75, 1e-9);
  EXPECT_NEAR(both.motion.mean_deg, 3, 1e-4);
  EXPECT_NEAR(both.motions[index(MotionId::Step)].p95_deg, 2, 1e-4);
  const auto only_b = [](const Scene& scene) { return scene.category == "b"; };
  EXPECT_EQ(summarise(scenes, records, System::Whole, only_b).swaps, 1);
  EXPECT_EQ(categories_of(scenes), (std::vector<std::string>{"a", "b"}));
}

TEST(SwapCounter, CountsAnExchangeOnceWhenItLastsLongerThanTwoFrames) {
  Skeleton truth;
  for (Joint& joint : truth.joints) joint.state = JointState::Observed;
  truth[LeftKnee].position = {0.1F, 0, 2};
  truth[RightKnee].position = {-0.1F, 0, 2};
  Skeleton swapped = truth;
  std::swap(swapped[LeftKnee].position, swapped[RightKnee].position);
  SwapCounter counter;
  for (const bool exchanged : {true, true, false, true, true, true, true, false}) {
    counter.add(truth, exchanged ? &swapped : &truth);
  }
  EXPECT_EQ(counter.count(), 1);
  // Nobody found ends it.
  for (int i = 0; i < 6; ++i) counter.add(truth, i % 2 == 0 ? &swapped : nullptr);
  EXPECT_EQ(counter.count(), 1);
}

TEST(SceneEvaluation, IsTheSameWhateverTheNumberOfThreads) {
  const auto scenes = scenes_of("standing", 2);
  SceneOptions options{.width = 160, .height = 120};
  const auto no_progress = [](double) {};
  const auto one = evaluate_scenes(installed_forest(), scenes, options, no_progress, {});
  options.threads = 2;
  const auto two = evaluate_scenes(installed_forest(), scenes, options, no_progress, {});
  ASSERT_TRUE(one && two);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    for (std::size_t s = 0; s < kSystemCount; ++s) {
      const SystemRecord &a = (*one)[i].systems[s], &b = (*two)[i].systems[s];
      EXPECT_EQ(a.frames, 60);
      ASSERT_EQ(a.joints.size(), b.joints.size());
      for (std::size_t k = 0; k < a.joints.size(); ++k) ASSERT_EQ(a.joints[k].error_m, b.joints[k].error_m);
      EXPECT_EQ(a.standing, b.standing);
    }
  }
  const SkeletonSummary mask = summarise(scenes, *one, System::Mask);
  EXPECT_GT(mask.navigation.average_precision, 0.8);
  EXPECT_GT(mask.rest_frames, 0);
}

TEST(SceneEvaluation, StopsWhenAsked) {
  std::stop_source stop;
  stop.request_stop();
  const auto records = evaluate_scenes(
      installed_forest(), scenes_of("standing", 2), {}, [](double) {}, stop.get_token());
  ASSERT_FALSE(records);
  EXPECT_EQ(records.error().message, "stopped after 0 scenes; nothing was measured");
}

TEST(PaperTracker, FindsSomebodyWhoStandsAndRemembersNothing) {
  const auto source = open_scene(scenes_of("standing", 3)[2], 320, 240);
  ASSERT_TRUE(source);
  PaperTracker paper(std::make_shared<const Forest>(paper_forest_of(*installed_forest())), 0);
  paper.reset((*source)->info().intrinsics);
  DepthFrame frame;
  ASSERT_TRUE((*source)->read(frame, std::chrono::seconds(1)));
  const auto owner = (*source)->truth().owner;
  const Skeleton first = paper.track(frame.view(), owner);
  const Skeleton truth = (*source)->truth().skeleton;
  for (const JointId joint : {Head, Neck, LeftShoulder, RightShoulder, LeftHip, RightKnee}) {
    EXPECT_LT((first[joint].position - truth[joint].position).norm(), 0.10F) << kJointNames[index(joint)];
  }
  // An empty mask has no joints, and leaves no trace.
  const std::vector<std::uint8_t> nobody(owner.size(), 0);
  for (const Joint& joint : paper.track(frame.view(), nobody).joints) EXPECT_EQ(joint.state, JointState::Lost);
  const Skeleton& again = paper.track(frame.view(), owner);
  for (std::size_t j = 0; j < kJointCount; ++j) EXPECT_EQ(again.joints[j].position, first.joints[j].position);
}

TEST(PaperTracker, HasThreeTreesAtMost) {
  std::vector<Tree> trees(4);
  for (Tree& tree : trees) tree.leaves.resize(1);
  EXPECT_EQ(paper_forest_of(*Forest::create(trees, "made by hand")).trees().size(), 3U);
  trees.resize(2);
  EXPECT_EQ(paper_forest_of(*Forest::create(trees, "made by hand")).trees().size(), 2U);
}

TEST(RealEvaluation, WhoSaysWhatTheSdkSaysAgreesWithIt) {
  const std::filesystem::path folder = "../shared/data/depth/utd";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
  // A tracker that answers with the SDK's joints, all of them 5 cm lower, in the order in which they are asked for.
  const auto names = list_utd_sequences(folder);
  ASSERT_TRUE(names);
  std::vector<Skeleton> answers;
  for (const std::string& name : *names) {
    const auto sequence = read_utd_sequence(folder, name);
    ASSERT_TRUE(sequence);
    if (sequence->action != 26 && sequence->action != 27 && sequence->action > 4 && sequence->action / 2 != 11)
      continue;
    for (const SdkJoints& joints : sequence->joints) {
      Skeleton& answer = answers.emplace_back();
      const auto put = [&](JointId to, SdkJoint from) {
        answer[to] = {joints[static_cast<std::size_t>(from)] + Eigen::Vector3f(0, 0.05F, 0), 1, JointState::Observed};
      };
      put(Head, SdkJoint::Head), put(Neck, SdkJoint::ShoulderCenter), put(Waist, SdkJoint::HipCenter);
      put(LeftShoulder, SdkJoint::LeftShoulder), put(RightShoulder, SdkJoint::RightShoulder);
      put(LeftHip, SdkJoint::LeftHip), put(RightHip, SdkJoint::RightHip), put(LeftKnee, SdkJoint::LeftKnee);
      put(RightKnee, SdkJoint::RightKnee), put(Torso, SdkJoint::Spine);
    }
  }
  std::size_t asked = 0;
  const MaskedTracker parrot{
      [](const Intrinsics&) {},
      [&](DepthView, std::span<const std::uint8_t>) -> const Skeleton& { return answers[asked++]; }};
  const auto real = evaluate_real(parrot, folder, false, [](double) {});
  ASSERT_TRUE(real) << real.error().message;
  EXPECT_LT(real->as_is.all.p90_m, 1e-5);
  EXPECT_EQ(real->as_is.within_15_cm, 1);
  EXPECT_EQ(real->sequences.size(), 32U);
  for (const MotionId motion :
       {MotionId::RotateShoulders, MotionId::LeanBust, MotionId::BendBust, MotionId::BendKnees}) {
    EXPECT_GT(real->as_is.correlation[index(motion)].mean, 0.9999) << kMotionNames[index(motion)];
    EXPECT_LT(real->delayed.correlation[index(motion)].mean, 0.9999);
    EXPECT_GE(real->as_is.correlation[index(motion)].median, real->as_is.correlation[index(motion)].mean - 1e-6);
    EXPECT_GT(real->as_is.correlation[index(motion)].sequences, 0);
  }
}

}  // namespace
}  // namespace armature::tools
