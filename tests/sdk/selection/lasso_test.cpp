#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <armature/sdk/selection/lasso.h>
#include <gtest/gtest.h>

#include "sdk/selection/flood.h"
#include "tests/sdk/mesh/surfaces.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

/// A ball of radius 1.
Mesh ball() {
  return surfaces::over({60, 60, false, true, 0}, [](double i, double j) {
    const double polar = std::numbers::pi * (1e-4 + (1 - 2e-4) * i);
    const double turn = 2 * std::numbers::pi * j;
    return Vector3d(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar));
  });
}

/// A loop about the z axis.
std::vector<Vector3d> circle(double radius, double z, int points = 40) {
  std::vector<Vector3d> loop;
  for (int i = 0; i < points; ++i) {
    const double turn = 2 * std::numbers::pi * i / points;
    loop.emplace_back(radius * std::cos(turn), radius * std::sin(turn), z);
  }
  return loop;
}

std::vector<FaceId> faces_where(const Mesh& mesh, const auto& wanted) {
  std::vector<FaceId> faces;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    if (wanted(middle(mesh, FaceId(f)))) faces.emplace_back(f);
  return faces;
}

TEST(Lasso, TakesWhatIsSeenInTheLoopAlongOneDirection) {
  const Mesh mesh = ball();
  const Surface surface(mesh);
  const auto taken = select_lasso(surface, {.loop = circle(0.5, 7), .seen_from = Gaze{{0, 0, -3}}}).value();
  // Between the inner and the outer circle of the 40-gon.
  const auto cap = [&](double radius) {
    return faces_where(mesh, [&](const Vector3d& p) { return p.z() > 0 && p.head<2>().norm() < radius; });
  };
  EXPECT_GE(taken.size(), cap(0.5 * std::cos(std::numbers::pi / 40)).size());
  EXPECT_LE(taken.size(), cap(0.5).size());
  for (const FaceId face : taken) EXPECT_GT(middle(mesh, face).z(), 0);
}

TEST(Lasso, TakesWhatIsHiddenWhenAsked) {
  const Mesh mesh = ball();
  const Surface surface(mesh);
  const Lasso seen{.loop = circle(0.5, 7), .seen_from = Gaze{{0, 0, -1}}};
  Lasso through = seen;
  through.through = true;
  EXPECT_EQ(select_lasso(surface, through)->size(), 2 * select_lasso(surface, seen)->size());
}

TEST(Lasso, LooksFromAnEyeWhereverOnTheirLinesThePointsLie) {
  const Mesh mesh = ball();
  const Surface surface(mesh);
  // From a distance of 2, the cap is seen up to z = 1/2, where lines of sight touch the ball.
  const Lasso near{.loop = circle(0.2, 1.8), .seen_from = Eye{{0, 0, 2}}};
  Lasso far = near;
  far.loop = circle(2, 0);
  const auto all_that_is_seen = select_lasso(surface, near).value();
  EXPECT_EQ(all_that_is_seen, select_lasso(surface, far).value());
  const auto cap = faces_where(mesh, [](const Vector3d& p) { return p.z() > 0.5; });
  EXPECT_NEAR(static_cast<double>(all_that_is_seen.size()), static_cast<double>(cap.size()), 0.05 * cap.size());
  for (const FaceId face : all_that_is_seen) EXPECT_GT(middle(mesh, face).z(), 0.45);
}

TEST(Lasso, OfALoopThatCrossesItselfTakesBothHalves) {
  const Mesh mesh = surfaces::over({20, 20, false, false, 0}, [](double i, double j) { return Vector3d(i, j, 0); });
  const Surface surface(mesh);
  const auto taken =
      select_lasso(surface, {.loop = {{0, 0, 1}, {1, 1, 1}, {1, 0, 1}, {0, 1, 1}}, .seen_from = Gaze{{0, 0, -1}}});
  // A face may lie on the loop.
  const auto more_to_the_side_by = [&](double margin) {
    return faces_where(mesh, [=](const Vector3d& p) { return std::abs(p.x() - 0.5) > std::abs(p.y() - 0.5) + margin; });
  };
  EXPECT_TRUE(std::ranges::includes(*taken, more_to_the_side_by(0.01)));
  EXPECT_TRUE(std::ranges::includes(more_to_the_side_by(-0.01), *taken));
}

TEST(Lasso, SaysWhatCannotBe) {
  const Mesh mesh = ball();
  const Surface surface(mesh);
  const auto refused = [&](const Lasso& lasso) {
    const auto taken = select_lasso(surface, lasso);
    return taken ? "accepted" : taken.error().message;
  };
  EXPECT_NE(refused({.loop = circle(1, 0, 2)}).find("three points"), std::string::npos);
  EXPECT_NE(refused({.loop = circle(1, 0), .seen_from = Gaze{}}).find("no direction"), std::string::npos);
  EXPECT_NE(refused({.loop = circle(0.1, 9), .seen_from = Gaze{{1, 0, 0}}}).find("no face"), std::string::npos);
  EXPECT_NE(
      refused({.loop = {{0, 0, 1}, {0, 1, 5}, {1, 0, 5}, {0, 0, -30}}, .seen_from = Eye{{0, 0, 0}}}).find("point 3"),
      std::string::npos);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refused({.loop = {{0, 0, 1}, {nan, 1, 5}, {1, 0, 5}}, .seen_from = Gaze{{0, 0, 1}}}).find("point 1"),
            std::string::npos);
}

}  // namespace
}  // namespace armature::sdk
