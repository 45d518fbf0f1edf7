#include "viewer/scene/camera.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace armature::viewer {
namespace {

using Eigen::Vector3d;

constexpr double kQuarterTurn = std::numbers::pi / 2;

/// Where a point lies in the picture: x right and y up in [-1, 1], and its depth.
Vector3d seen(const Camera& camera, const Vector3d& point) {
  const Vector3d view = camera.view_from_world * point;
  return {view.x() / -view.z() / camera.half_width, view.y() / -view.z() / camera.half_height, -view.z()};
}

Camera looking_at_unit_ball(const View& view, double aspect = 1) {
  CameraFit fit(view, aspect);
  fit.include(sdk::Sphere{Vector3d::Zero(), 1});
  return fit.camera();
}

/// Right, up and towards the viewer, each 0.5 from the centre, are where the picture has them.
void expect_axes(const View& view, const Vector3d& right, const Vector3d& up, const Vector3d& towards) {
  const Camera camera = looking_at_unit_ball(view);
  const double middle = seen(camera, Vector3d::Zero()).z();
  EXPECT_GT(seen(camera, 0.5 * right).x(), 0.4);
  EXPECT_NEAR(seen(camera, 0.5 * right).y(), 0, 1e-12);
  EXPECT_GT(seen(camera, 0.5 * up).y(), 0.4);
  EXPECT_NEAR(seen(camera, 0.5 * up).x(), 0, 1e-12);
  EXPECT_NEAR(seen(camera, 0.5 * towards).z(), middle - 0.5, 1e-12);
}

TEST(Camera, SeesTheFrontOfAModelWhoseYOrZIsUp) {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  expect_axes({}, x, y, z);
  expect_axes({.up = Up::Z}, x, z, -y);
  expect_axes({.up = Up::MinusY}, x, -y, -z);
  expect_axes({.up = Up::MinusZ}, x, -z, y);
}

TEST(Camera, PutsEveryUpDirectionUp) {
  for (const auto& [up, direction] :
       {std::pair{Up::X, Vector3d{1, 0, 0}}, std::pair{Up::Y, Vector3d{0, 1, 0}}, std::pair{Up::Z, Vector3d{0, 0, 1}},
        std::pair{Up::MinusX, Vector3d{-1, 0, 0}}, std::pair{Up::MinusY, Vector3d{0, -1, 0}},
        std::pair{Up::MinusZ, Vector3d{0, 0, -1}}}) {
    const Camera camera = looking_at_unit_ball({.up = up});
    EXPECT_GT(seen(camera, 0.5 * direction).y(), 0.4);
    EXPECT_NEAR(camera.view_from_world.linear().determinant(), 1, 1e-12) << "a picture must not be mirrored";
  }
}

TEST(Camera, TurnsAroundTheModelAndRisesAboveIt) {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  expect_axes({.azimuth_rad = kQuarterTurn}, -z, y, x);
  expect_axes({.azimuth_rad = -kQuarterTurn}, z, y, -x);
  expect_axes({.elevation_rad = kQuarterTurn}, x, -z, y);
}

TEST(Camera, FillsThePictureAsFarAsItGoes) {
  for (const double aspect : {0.5, 1.0, 2.0}) {
    CameraFit fit({.azimuth_rad = 0.3, .elevation_rad = 0.2}, aspect);
    const std::array<Vector3d, 5> points = {Vector3d{5, 0, 0}, {-1, 0.5, 3}, {0, -2, 0}, {1, 1, -7}, {4, 3, 2}};
    for (const Vector3d& point : points) fit.include(sdk::Sphere{point, 0});
    const Camera camera = fit.camera();
    Vector3d least = Vector3d::Constant(1e9), most = -least;
    for (const Vector3d& point : points) {
      least = least.cwiseMin(seen(camera, point));
      most = most.cwiseMax(seen(camera, point));
    }
    EXPECT_NEAR(std::max(most.x() - least.x(), most.y() - least.y()), 2 * 0.93, 0.03);
    EXPECT_LE(most.x(), 0.93 + 1e-9);
    EXPECT_LE(most.y(), 0.93 + 1e-9);
    EXPECT_GE(least.x(), -0.93 - 1e-9);
    EXPECT_GE(least.y(), -0.93 - 1e-9);
    EXPECT_LT(camera.near, least.z());
    EXPECT_GT(camera.far, most.z());
  }
}

TEST(Camera, LooksAtNothingAndAtASinglePointWithoutFailing) {
  EXPECT_TRUE(CameraFit({}, 1).camera().view_from_world.matrix().allFinite());
  for (const double away : {0.0, 1.0, -1e6}) {
    CameraFit fit({}, 1);
    fit.include(sdk::Sphere{Vector3d::Constant(away), 0});
    const Camera camera = fit.camera();
    EXPECT_NEAR(seen(camera, Vector3d::Constant(away)).x(), 0, 1e-6);
    EXPECT_GT(camera.near, 0);
    EXPECT_GT(camera.far, camera.near);
  }
}

}  // namespace
}  // namespace armature::viewer
