#include "tools/evaluation/surface_turn.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tools/evaluation/statistics.h"
#include "tracker/synth/training_images.h"

namespace armature::tools {
namespace {

constexpr double kMaxTurn_rad = 25 * std::numbers::pi / 180;
constexpr double kShare = 0.8;  // of a turn, what the surface shows of it

double turn_of(const Skeleton& skeleton, JointId left, JointId right) {
  const Eigen::Vector3f across = skeleton[left].position - skeleton[right].position;
  return std::atan2(across.z(), across.x());
}

/// How turns of a strip's surface and of its joints agree on synthetic people who more or less face the camera, with
/// nothing before them.
void expect_agreement(JointId left, JointId right, TrunkStrip (*strip_of)(const Skeleton&) noexcept) {
  TrainingOptions options;
  options.turned_deg = 25;
  options.occluded = options.company = 0;
  options.carries = false;
  TrainingSampler sampler(options);
  LabelledImage image;
  std::vector<double> turns, misses;
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    sampler.sample(seed, image);
    Skeleton truth;
    for (std::size_t j = 0; j < kJointCount; ++j) truth.joints[j].position = image.joints[j];
    const double turn = turn_of(truth, left, right);
    if (std::abs(turn) > kMaxTurn_rad) continue;
    const auto seen =
        surface_turn({.depth_mm = image.depth_mm, .intrinsics = image.intrinsics, .sensor = {}, .host = {}}, image.user,
                     strip_of(truth));
    if (!seen) continue;
    turns.push_back(std::abs(turn));
    misses.push_back(std::abs(*seen - kShare * turn));
  }
  // The median: now and then an arm lies before the trunk.
  EXPECT_GT(turns.size(), 60U);
  EXPECT_LT(percentile(misses, 50), 0.3 * percentile(turns, 50));
}

TEST(SurfaceTurn, OfShouldersAndHipsFollowsTheJointsOfSyntheticPeople) {
  expect_agreement(JointId::LeftShoulder, JointId::RightShoulder, shoulder_strip);
  expect_agreement(JointId::LeftHip, JointId::RightHip, hip_strip);
}

TEST(SurfaceTurn, OfNobodyIsNothing) {
  const std::vector<std::uint16_t> depth_mm(std::size_t{8} * 6, 0);
  const std::vector<std::uint8_t> mask(depth_mm.size(), 1);
  const Intrinsics k{.width = 8, .height = 6, .focal_x_px = 8, .focal_y_px = 8, .centre_x_px = 4, .centre_y_px = 3};
  const DepthView frame{.depth_mm = depth_mm, .intrinsics = k, .sensor = {}, .host = {}};
  EXPECT_FALSE(surface_turn(frame, mask, {.top = {0, -0.2F, 2}, .bottom = {0, 0.2F, 2}}));
  EXPECT_FALSE(surface_turn(frame, mask, {.top = {0, -0.2F, 0}, .bottom = {0, 0.2F, 0}}));
}

TEST(SurfaceTurn, OfOneColumnOrOneRowIsNothing) {
  const Intrinsics k{
      .width = 80, .height = 80, .focal_x_px = 80, .focal_y_px = 80, .centre_x_px = 40, .centre_y_px = 40};
  const std::vector<std::uint16_t> depth_mm(std::size_t{80} * 80, 400);
  const DepthView frame{.depth_mm = depth_mm, .intrinsics = k, .sensor = {}, .host = {}};
  const TrunkStrip strip{.top = {0, -0.18F, 0.4F}, .bottom = {0, 0.18F, 0.4F}};
  std::vector<std::uint8_t> all(depth_mm.size(), 1), column(depth_mm.size(), 0), row(depth_mm.size(), 0);
  for (std::size_t i = 0; i < 80; ++i) column[i * 80 + 45] = row[std::size_t{45} * 80 + i] = 1;
  ASSERT_TRUE(surface_turn(frame, all, strip));
  EXPECT_NEAR(*surface_turn(frame, all, strip), 0, 1e-9);
  EXPECT_FALSE(surface_turn(frame, column, strip));
  EXPECT_FALSE(surface_turn(frame, row, strip));
}

}  // namespace
}  // namespace armature::tools
