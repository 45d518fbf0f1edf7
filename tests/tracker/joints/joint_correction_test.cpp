#include "tracker/joints/joint_correction.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace armature {
namespace {

Skeleton some_skeleton() {
  Skeleton skeleton;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    const auto t = static_cast<float>(j);
    skeleton.joints[j] = {
        {0.4F + 0.02F * t, 0.9F - 0.05F * t, 2.5F + 0.01F * std::fmod(7 * t, 11.0F)}, 0.03F * t, JointState::Observed};
  }
  return skeleton;
}

RestingBody resting() {
  RestingBody body;
  body.add(some_skeleton());
  return body;
}

/// The skeleton walked round the camera, at the same distance and height.
Skeleton turned(Skeleton skeleton, float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  for (Joint& joint : skeleton.joints) {
    const Eigen::Vector3f p = joint.position;
    joint.position = {c * p.x() + s * p.z(), p.y(), c * p.z() - s * p.x()};
  }
  return skeleton;
}

std::array<float, kCorrectionInputs> inputs_of(const Skeleton& skeleton) {
  std::array<float, kCorrectionInputs> inputs{};
  correction_inputs(skeleton, resting(), CorrectionFrame(skeleton), inputs);
  return inputs;
}

std::shared_ptr<const Forest> forest_with(std::vector<float> bias) {
  Tree stump;
  stump.leaves.resize(1);
  PerceptronLayer layer{.inputs = kCorrectionInputs,
                        .outputs = kCorrectionOutputs,
                        .weights = std::vector<float>(std::size_t{kCorrectionInputs} * kCorrectionOutputs),
                        .bias = std::move(bias)};
  return std::make_shared<const Forest>(
      *Forest::create({stump}, "")->corrected_by(*Perceptron::create({std::move(layer)})));
}

TEST(JointCorrection, ItDoesNotMatterWhereInTheImageSomebodyStands) {
  const auto here = inputs_of(some_skeleton());
  const auto there = inputs_of(turned(some_skeleton(), -0.5F));
  for (std::size_t i = 0; i < here.size(); ++i) EXPECT_NEAR(here[i], there[i], 1e-5) << i;
}

TEST(JointCorrection, TheFrameTurnsThereAndBack) {
  const CorrectionFrame frame(some_skeleton());
  const Eigen::Vector3f v(0.3F, -0.2F, 0.7F);
  EXPECT_TRUE(frame.turned_back(frame.turned(v)).isApprox(v, 1e-6F));
  EXPECT_NEAR(frame.seen(frame.origin()).norm(), 0, 1e-6);
  EXPECT_NEAR(frame.turned(frame.origin()).x(), 0, 1e-6);  // straight ahead
}

TEST(JointCorrection, MovesJointsAlongTheFrameAndSaysHowSureItIs) {
  std::vector<float> bias(kCorrectionOutputs);
  bias[3 * index(JointId::Head) + 2] = 0.05F;  // away from the camera
  for (std::size_t j = 0; j < kJointCount; ++j) bias[3 * kJointCount + j] = 0.1F;
  Skeleton skeleton = some_skeleton();
  JointCorrection(forest_with(bias)).apply(skeleton, resting());
  const Skeleton before = some_skeleton();
  const Eigen::Vector3f ahead = CorrectionFrame(before).turned_back(Eigen::Vector3f::UnitZ());
  EXPECT_TRUE(skeleton[JointId::Head].position.isApprox(before[JointId::Head].position + 0.05F * ahead, 1e-5F));
  EXPECT_EQ(skeleton[JointId::LeftFoot].position, before[JointId::LeftFoot].position);
  EXPECT_NEAR(skeleton[JointId::Waist].confidence, 0.5, 0.01);  // 10 cm expected
}

TEST(JointCorrection, SomebodyAndHerMirrorImageAreCorrectedAlike) {
  std::vector<float> bias(kCorrectionOutputs);
  for (std::size_t i = 0; i < 3 * kJointCount; ++i) bias[i] = 0.001F * static_cast<float>(i % 17);
  Skeleton skeleton = some_skeleton(), other = mirrored(some_skeleton());
  JointCorrection(forest_with(bias)).apply(skeleton, resting());
  JointCorrection(forest_with(bias)).apply(other, resting().mirrored());
  const Skeleton back = mirrored(other);
  for (std::size_t j = 0; j < kJointCount; ++j) {
    EXPECT_TRUE(back.joints[j].position.isApprox(skeleton.joints[j].position, 1e-5F)) << j;
  }
}

TEST(RestingBody, IsAMeanInWhichWalkingAboutDoesNotShow) {
  RestingBody standing, walking;
  for (int i = 0; i < 20; ++i) {
    standing.add(some_skeleton());
    walking.add(turned(some_skeleton(), 0.02F * static_cast<float>(i)));
  }
  for (std::size_t j = 0; j < kJointCount; ++j) {
    EXPECT_LT((walking.seen()[j] - standing.seen()[j]).norm(), 1e-4F) << j;
  }
}

TEST(JointCorrection, ALostJointStaysLostWhereItWas) {
  std::vector<float> bias(kCorrectionOutputs, 0.05F);
  Skeleton skeleton = some_skeleton();
  skeleton[JointId::Head] = {{1, 2, 3}, 0, JointState::Lost};
  JointCorrection(forest_with(bias)).apply(skeleton, resting());
  EXPECT_EQ(skeleton[JointId::Head].position, Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(skeleton[JointId::Head].confidence, 0);
  EXPECT_NE(skeleton[JointId::Neck].position, some_skeleton()[JointId::Neck].position);
}

TEST(JointCorrection, ANetworkThatGoesWildMovesNothing) {
  std::vector<float> bias(kCorrectionOutputs, std::numeric_limits<float>::max());
  Skeleton skeleton = some_skeleton();
  JointCorrection(forest_with(bias)).apply(skeleton, resting());
  for (std::size_t j = 0; j < kJointCount; ++j) {
    EXPECT_EQ(skeleton.joints[j].position, some_skeleton().joints[j].position) << j;
  }
}

TEST(JointCorrection, AForestWithoutOneLeavesJointsAlone) {
  const auto plain = std::make_shared<const Forest>(forest_with(std::vector<float>(kCorrectionOutputs))->uncorrected());
  Skeleton skeleton = some_skeleton();
  JointCorrection(plain).apply(skeleton, resting());
  EXPECT_EQ(skeleton[JointId::Head].position, some_skeleton()[JointId::Head].position);
  EXPECT_EQ(skeleton[JointId::Head].confidence, some_skeleton()[JointId::Head].confidence);
}

TEST(JointCorrection, ANetworkOfAnotherShapeIsRefused) {
  const auto forest = forest_with(std::vector<float>(kCorrectionOutputs));
  const auto refused =
      forest->corrected_by(*Perceptron::create({{.inputs = 1, .outputs = 2, .weights = {1, 2}, .bias = {0, 0}}}));
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().message, "a correction of 1 inputs and 2 outputs, expected 236 and 120");
}

}  // namespace
}  // namespace armature
