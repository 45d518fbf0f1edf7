#include <cmath>
#include <filesystem>

#include <Eigen/Geometry>
#include <armature/sdk/distance/measure.h>
#include <armature/sdk/hierarchy/build.h>
#include <armature/sdk/hierarchy/level_cursor.h>
#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/mesh/measures.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/sdk/hierarchy/shapes.h"
#include "tests/sdk/mesh/surfaces.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;
using surfaces::mesh_of;

/// The cube [0, side]^3.
Mesh cube(double side) {
  std::vector<Vector3d> corners;
  for (int k = 0; k < 8; ++k) corners.push_back(side * Vector3d(k & 1, k >> 1 & 1, k >> 2));
  return mesh_of(std::move(corners), {{0, 2, 3},
                                      {0, 3, 1},
                                      {4, 5, 7},
                                      {4, 7, 6},
                                      {0, 1, 5},
                                      {0, 5, 4},
                                      {2, 6, 7},
                                      {2, 7, 3},
                                      {0, 4, 6},
                                      {0, 6, 2},
                                      {1, 3, 7},
                                      {1, 7, 5}});
}

SphereMesh one_sphere(const Vector3d& centre, double radius) {
  SphereMesh shape;
  shape.spheres = {{centre, radius}};
  return shape;
}

TEST(Measure, AShapeIsNoDistanceFromItself) {
  const auto errors = measure(cube(3), cube(3));
  ASSERT_TRUE(errors);
  EXPECT_NEAR(errors->hausdorff, 0, 1e-9);
  EXPECT_NEAR(errors->mean_input_to_approximation, 0, 1e-9);
  EXPECT_NEAR(errors->mean_approximation_to_input, 0, 1e-9);
}

TEST(Measure, ParallelSquaresAreTheirDistanceApart) {
  const Mesh low = mesh_of({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}});
  Mesh high = low;
  for (Vector3d& p : high.positions) p.z() = 0.1;
  const auto errors = measure(low, high);
  ASSERT_TRUE(errors);
  const double expected = 100 * 0.1 / std::sqrt(2.0);
  EXPECT_NEAR(errors->hausdorff, expected, 1e-9);
  EXPECT_NEAR(errors->mean_input_to_approximation, expected, 1e-9);
  EXPECT_NEAR(errors->mean_approximation_to_input, expected, 1e-9);
}

TEST(Measure, ACubeInItsInscribedBall) {
  // Cube of side 2, ball of radius 1 in its middle. From the cube: the distance to the centre less 1.
  Mesh box = cube(2);
  const auto errors = measure(box, one_sphere({1, 1, 1}, 1));
  ASSERT_TRUE(errors);
  const double diagonal = 2 * std::sqrt(3.0);
  EXPECT_NEAR(errors->hausdorff, 100 * (std::sqrt(3.0) - 1) / diagonal, 1e-9);
  // Mean of sqrt(1 + x^2 + y^2) - 1 over the square [-1, 1]^2 is 0.2807896 (the mean distance from a cube's centre to
  // its surface, 1.2807896, known in closed form).
  EXPECT_NEAR(errors->mean_input_to_approximation, 100 * 0.2807896 / diagonal, 1e-3);
  // The mean of the largest coordinate over the sphere is 0.83119 (by quadrature over one face of the cube).
  EXPECT_NEAR(errors->mean_approximation_to_input, 100 * (1 - 0.83119) / diagonal, 1e-3);
}

TEST(Measure, IsInPercentOfTheInputsDiagonalAtAnyScale) {
  const auto small = measure(cube(2), one_sphere({1, 1, 1}, 1.2), {.samples = 20000});
  const auto large = measure(cube(2e6), one_sphere(1e6 * Vector3d(1, 1, 1), 1.2e6), {.samples = 20000});
  ASSERT_TRUE(small && large);
  EXPECT_NEAR(small->hausdorff, large->hausdorff, 1e-6);
  EXPECT_NEAR(small->mean_input_to_approximation, large->mean_input_to_approximation, 1e-6);
  EXPECT_NEAR(small->mean_approximation_to_input, large->mean_approximation_to_input, 1e-6);
}

TEST(Measure, ThreadsDoNotChangeTheResult) {
  SphereMesh shape = one_sphere({0.5, 0.5, 0.5}, 0.6);
  shape.spheres.push_back({{1.5, 1.4, 1.3}, 0.5});
  shape.spheres.push_back({{0.5, 1.4, 1.3}, 0.7});
  shape.edges = {{SphereId(0), SphereId(1)}, {SphereId(1), SphereId(2)}};
  const auto many = measure(cube(2), shape, {.samples = 30000});
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto alone = measure(cube(2), shape, {.samples = 30000});
  ASSERT_TRUE(many && alone);
  EXPECT_EQ(many->hausdorff, alone->hausdorff);
  EXPECT_EQ(many->mean_input_to_approximation, alone->mean_input_to_approximation);
  EXPECT_EQ(many->mean_approximation_to_input, alone->mean_approximation_to_input);
}

/// A ball with waves, and a level of its hierarchy.
std::pair<Mesh, SphereMesh> waves_and_level(std::size_t spheres) {
  Mesh mesh = ball(4);
  for (Vector3d& p : mesh.positions) p *= 1 + 0.2 * std::sin(5 * p.x()) * std::sin(4 * p.y() + 3 * p.z());
  const auto built = build_hierarchy(mesh, {});
  return {std::move(mesh), LevelCursor(built->hierarchy, spheres).sphere_mesh()};
}

TEST(Measure, WhatIsMeasuredQuicklyHasTheSameMeansAndNoLargerDistance) {
  // At fine levels walls are thin, and what is within must not be taken for outer surface: the full measure was 9.1 %
  // where 0.12 % is right.
  for (const std::size_t spheres : {40U, 500U, 850U}) {
    const auto [mesh, shape] = waves_and_level(spheres);
    const auto quick = measure(mesh, shape, {.samples = 10000, .quick = true});
    const auto same = measure(mesh, shape, {.samples = 10000}), finer = measure(mesh, shape, {.samples = 40000});
    ASSERT_TRUE(quick && same && finer);
    EXPECT_NEAR(quick->mean_input_to_approximation / same->mean_input_to_approximation, 1, 1e-4);
    EXPECT_EQ(quick->mean_approximation_to_input, same->mean_approximation_to_input);
    EXPECT_LE(quick->hausdorff, same->hausdorff);
    EXPECT_GT(quick->hausdorff, 0.9 * same->hausdorff);
    EXPECT_NEAR(quick->mean_input_to_approximation / finer->mean_input_to_approximation, 1, 0.03);
    EXPECT_NEAR(quick->mean_approximation_to_input / finer->mean_approximation_to_input, 1, 0.03);
  }
}

TEST(Measure, WhatCannotBeComparedIsRefused) {
  EXPECT_FALSE(measure(Mesh{}, one_sphere({0, 0, 0}, 1)));
  EXPECT_FALSE(measure(cube(1), SphereMesh{}));
  EXPECT_FALSE(measure(cube(1), Mesh{}));
  EXPECT_FALSE(measure(cube(0), one_sphere({0, 0, 0}, 1)));
}

TEST(Measure, AnInputWithoutAreaIsComparedAtItsCorners) {
  const Mesh line = mesh_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}});
  const auto errors = measure(line, one_sphere({0, 0, 0}, 1));
  ASSERT_TRUE(errors);
  EXPECT_NEAR(errors->mean_input_to_approximation, 100 * (2.0 / 3) / 2, 1e-9);
}

TEST(Measure, StopsWhenAsked) {
  std::stop_source source;
  source.request_stop();
  const auto errors = measure(cube(1), one_sphere({0, 0, 0}, 1), {}, {.stop = source.get_token()});
  ASSERT_FALSE(errors);
  EXPECT_EQ(errors.error().kind, ErrorKind::Cancelled);
}

TEST(Measure, TwiceTheSamplesChangeTheMeansInTheFourthDigitOnARealModel) {
  const std::filesystem::path path = "../shared/data/meshes/vm_bear.off";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no models at " << path;
  const auto mesh = read_mesh(path);
  ASSERT_TRUE(mesh) << mesh.error().message;
  const Eigen::AlignedBox3d box = bounding_box(*mesh);
  SphereMesh shape;
  const Vector3d step = box.sizes() / 4;
  for (int k = 0; k < 9; ++k)
    shape.spheres.push_back(
        {box.center() + step.cwiseProduct(Vector3d(k % 3 - 1, k / 3 - 1, k % 2)), 0.1 * box.sizes().norm()});
  for (std::size_t k = 0; k + 2 < shape.spheres.size(); ++k)
    shape.triangles.push_back({SphereId(k), SphereId(k + 1), SphereId(k + 2)});
  const auto some = measure(*mesh, shape, {.samples = 100000});
  const auto more = measure(*mesh, shape, {.samples = 200000});
  ASSERT_TRUE(some && more);
  EXPECT_NEAR(some->mean_input_to_approximation / more->mean_input_to_approximation, 1, 1e-3);
  EXPECT_NEAR(some->mean_approximation_to_input / more->mean_approximation_to_input, 1, 1e-3);
}

}  // namespace
}  // namespace armature::sdk
