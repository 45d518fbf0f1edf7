// What the tracker makes of synthetic people, end to end: depth in, velocities out. The people are not among those that
// the forest was trained on. Accuracy here is synthetic accuracy.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <armature/navproto/nav_camera.h>
#include <gtest/gtest.h>

#include "tools/tracking/steering_run.h"
#include "tracker/installation.h"

namespace armature {
namespace {

using tools::SteeringFrame;
using enum MotionId;

std::vector<SteeringFrame> steer(const std::string& uri, const SteeringPair& pair) {
  static const auto forest = Forest::load(installed_model());
  if (!forest) throw std::runtime_error(forest.error().message);
  TrackerOptions options;
  options.navigation.pair = pair;
  options.navigation.allow_correlated = true;
  auto frames = tools::run_steering(uri, std::make_shared<const Forest>(*forest), options);
  if (!frames) throw std::runtime_error(frames.error().message);
  return *frames;
}

/// A motion to steer with beside `motion`, which the script does not perform: the default pair's other half, or, where
/// that is correlated with it, the other half's like.
MotionId partner(MotionId motion) {
  if (motion == LeanBust || motion == RotateShoulders || motion == RotateHips || motion == TranslateHips) {
    return BendKnees;
  }
  return motion == BendBust ? RotateShoulders : LeanBust;
}

class MotionAlone : public testing::TestWithParam<MotionId> {};

TEST_P(MotionAlone, ComesOutRightAndSteersNothingElse) {
  const MotionId motion = GetParam();
  const std::string name(kMotionNames[index(motion)]);
  std::vector<std::vector<SteeringFrame>> runs;
  int engaged = 0, strayed = 0, present = 0;
  for (const char* seed : {"11", "12"}) {
    runs.push_back(steer(name + "?size=320x240&seed=" + seed, {motion, partner(motion)}));
    for (const SteeringFrame& frame : runs.back()) {
      present += frame.present;
      if (!frame.engaged || !frame.present) continue;
      ++engaged;
      strayed += frame.tracked.walk != 0;
    }
  }
  const auto [frames, median, p95, slope, delay, gain, far_gain, crosstalk] =
      tools::motion_accuracy(runs, motion, NavigationOptions{}.motions);
  std::printf("%-17s error median %.3f p95 %.3f of its range; %s strays in %.2f %% of %d frames; slope %.2f\n",
              name.c_str(), median, p95, std::string(kMotionNames[index(partner(motion))]).c_str(),
              100.0 * strayed / engaged, engaged, slope);
  EXPECT_GE(engaged, 0.9 * present);
  EXPECT_LE(median, 0.10);
  EXPECT_LE(p95, 0.25);
  EXPECT_LE(strayed, 0.01 * engaged);
}

INSTANTIATE_TEST_SUITE_P(Steering, MotionAlone,
                         testing::Values(RotateShoulders, RotateHips, LeanBust, BendBust, TranslateHips, BendKnees,
                                         Step),
                         [](const auto& test) { return std::string(kMotionNames[index(test.param)]); });

/// The nine pairs of section 3.5.3.
constexpr SteeringPair kPairs[] = {{RotateShoulders, BendBust}, {RotateShoulders, BendKnees}, {RotateShoulders, Step},
                                   {RotateHips, BendBust},      {RotateHips, BendKnees},      {RotateHips, Step},
                                   {LeanBust, BendBust},        {LeanBust, BendKnees},        {LeanBust, Step}};

class PairAlongAPath : public testing::TestWithParam<int> {};

TEST_P(PairAlongAPath, WalksItsPath) {
  const SteeringPair pair = kPairs[GetParam()];
  const char letter = static_cast<char>('a' + GetParam());
  const auto frames = steer(std::string("pair_") + letter + "?size=320x240&seed=11", pair);
  navproto::NavCamera truth, tracked;
  double length = 0, deviation = 0, farthest = 0;
  for (const SteeringFrame& frame : frames) {
    if (!frame.engaged) continue;
    const auto velocity = [](const Navigation& n) {
      return navproto::Velocity{n.velocity.linear_m_s, n.velocity.angular_rad_s};
    };
    truth.advance(velocity(frame.truth), frame.dt);
    tracked.advance(velocity(frame.tracked), frame.dt);
    const double dt_s = std::chrono::duration<double>(frame.dt).count();
    length += std::abs(double(frame.truth.velocity.linear_m_s)) * dt_s;
    const auto a = truth.pose(), b = tracked.pose();
    const double apart = std::hypot(a.x_m - b.x_m, a.y_m - b.y_m);
    deviation += apart;
    farthest = std::max(farthest, apart);
  }
  deviation /= static_cast<double>(frames.size());
  std::printf("pair_%c  path %.1f m; the tracked path is %.2f m off on average, %.2f m at most\n", letter, length,
              deviation, farthest);
  EXPECT_GT(length, 3);
  EXPECT_LE(deviation, 0.10 * length);
}

INSTANTIATE_TEST_SUITE_P(Steering, PairAlongAPath, testing::Range(0, 9),
                         [](const auto& test) { return std::string(1, static_cast<char>('a' + test.param)); });

TEST(Steering, ArmsAloneMoveNothing) {
  int engaged = 0, moving = 0;
  for (const SteeringFrame& frame : steer("arms?size=320x240&seed=11", {LeanBust, BendKnees})) {
    if (!frame.engaged) continue;
    ++engaged;
    moving += frame.tracked.velocity.linear_m_s != 0 || frame.tracked.velocity.angular_rad_s != 0;
  }
  std::printf("arms: velocities non-zero in %d of %d frames\n", moving, engaged);
  ASSERT_GT(engaged, 200);
  EXPECT_LE(moving, 0.01 * engaged);
}

}  // namespace
}  // namespace armature
