#include <cmath>
#include <limits>
#include <numbers>

#include <armature/navproto/nav_camera.h>
#include <gtest/gtest.h>

namespace armature::navproto {
namespace {

using std::numbers::pi;
using Seconds = std::chrono::duration<double>;

void expect_pose(const NavCamera& camera, double x_m, double y_m, double heading_rad, double tolerance = 1e-12) {
  EXPECT_NEAR(camera.pose().x_m, x_m, tolerance);
  EXPECT_NEAR(camera.pose().y_m, y_m, tolerance);
  EXPECT_NEAR(camera.pose().heading_rad, heading_rad, tolerance);
}

TEST(NavCamera, WalksStraightAhead) {
  NavCamera camera;
  camera.advance({1.5, 0}, Seconds(2));
  expect_pose(camera, 3, 0, 0);
}

TEST(NavCamera, PositiveTurnIsToTheLeft) {
  NavCamera camera;
  camera.rotate(pi / 2);
  camera.move(2);
  expect_pose(camera, 0, 2, pi / 2);
}

TEST(NavCamera, BackwardsIsNegative) {
  NavCamera camera({1, 1, pi});
  camera.move(-2);
  expect_pose(camera, 3, 1, pi);
}

TEST(NavCamera, AQuarterCircleToTheLeftEndsAtItsRadius) {
  NavCamera camera;
  // Radius v / w = 2 m about (0, 2).
  camera.advance({pi, pi / 2}, Seconds(1));
  expect_pose(camera, 2, 2, pi / 2);
}

TEST(NavCamera, AFullCircleToTheRightComesBack) {
  NavCamera camera;
  camera.advance({1, -2 * pi}, Seconds(1));
  expect_pose(camera, 0, 0, -2 * pi);
}

TEST(NavCamera, TheFrameRateDoesNotChangeThePath) {
  NavCamera once;
  NavCamera often;
  const Velocity velocity{1.2, 0.7};
  once.advance(velocity, Seconds(3));
  for (int i = 0; i < 3000; ++i) often.advance(velocity, Seconds(0.001));
  expect_pose(often, once.pose().x_m, once.pose().y_m, once.pose().heading_rad, 1e-9);  // metres, radians: rounding
}

TEST(NavCamera, ATurnTooSmallToMeasureIsAStraightLine) {
  NavCamera camera;
  camera.advance({1, 1e-300}, Seconds(1));
  expect_pose(camera, 1, 0, 0);
}

TEST(NavCamera, TurnsOnTheSpot) {
  NavCamera camera({4, 5, 0.5});
  camera.advance({0, -1}, Seconds(0.25));
  expect_pose(camera, 4, 5, 0.25);
}

TEST(NavCamera, IgnoresWhatIsNoMotion) {
  NavCamera camera({1, 2, 3});
  camera.advance({std::numeric_limits<double>::quiet_NaN(), 0}, Seconds(1));
  camera.advance({0, std::numeric_limits<double>::infinity()}, Seconds(1));
  camera.advance({1, 1}, Seconds(-1));
  camera.advance({1, 1}, Seconds(0));
  camera.advance({1, 1}, Seconds(std::numeric_limits<double>::quiet_NaN()));
  expect_pose(camera, 1, 2, 3, 0);
}

}  // namespace
}  // namespace armature::navproto
