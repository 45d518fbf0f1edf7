#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>

#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/mesh/curvature.h>
#include <armature/sdk/mesh/measures.h>
#include <gtest/gtest.h>

#include "tests/sdk/mesh/surfaces.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

std::vector<PrincipalCurvatures> curvatures(const Mesh& mesh) {
  return principal_curvatures(mesh, Adjacency(mesh)).value();
}

/// The largest error of k1 or k2 against what `expected` tells, over the vertices that `counts` keeps.
template <class Expected, class Counts>
double worst(const Mesh& mesh, const Expected& expected, const Counts& counts) {
  const auto found = curvatures(mesh);
  double error = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (!counts(mesh.positions[i])) continue;
    const PrincipalCurvatures truth = expected(mesh.positions[i]);
    error = std::max({error, std::abs(found[i].k1 - truth.k1), std::abs(found[i].k2 - truth.k2)});
  }
  return error;
}

constexpr auto kEverywhere = [](const Vector3d&) { return true; };

TEST(Curvature, OfASphereIsOneOverItsRadiusToAPercent) {
  const auto truth = [](const Vector3d&) { return PrincipalCurvatures{0.5, 0.5}; };
  EXPECT_LT(worst(surfaces::icosphere(4, 2), truth, kEverywhere), 0.01 * 0.5);
  // Inside out it is a hollow.
  const auto hollow = [](const Vector3d&) { return PrincipalCurvatures{-0.5, -0.5}; };
  EXPECT_LT(worst(surfaces::inside_out(surfaces::icosphere(4, 2)), hollow, kEverywhere), 0.01 * 0.5);
}

TEST(Curvature, OfACylinderIsOneOverItsRadiusAndZeroToAPercentUpToItsEnds) {
  const auto truth = [](const Vector3d&) { return PrincipalCurvatures{2, 0}; };
  EXPECT_LT(worst(surfaces::cylinder(0.5, 2), truth, kEverywhere), 0.01 * 2);
  EXPECT_LT(worst(surfaces::cylinder(0.5, 2, 60, 30, 0.3), truth, kEverywhere), 0.04 * 2);
}

TEST(Curvature, OfATorusIsThatOfItsTubeAndOfItsRingToTwoPercent) {
  const auto truth = [](const Vector3d& p) {
    const double ring = p.head<2>().norm();
    return PrincipalCurvatures{1, (ring - 3) / ring};
  };
  EXPECT_LT(worst(surfaces::torus(3, 1, 120, 60), truth, kEverywhere), 0.02);
  EXPECT_LT(worst(surfaces::torus(3, 1, 120, 60, 0.3), truth, kEverywhere), 0.04);
}

TEST(Curvature, OfASaddleHasBothSigns) {
  const Mesh saddle = surfaces::paraboloid(1, -2, 60);
  const auto middle = [](const Vector3d& p) { return p.norm() < 1e-9; };
  EXPECT_LT(worst(
                saddle,
                [](const Vector3d&) {
                  return PrincipalCurvatures{2, -1};
                },
                middle),
            0.02);
}

TEST(Curvature, OfAPlaneIsZeroUpToItsBoundary) {
  EXPECT_LT(
      worst(
          surfaces::paraboloid(0, 0, 10, 0.4), [](const Vector3d&) { return PrincipalCurvatures{}; }, kEverywhere),
      1e-12);
}

TEST(Curvature, OfANoisySphereIsRightInTheMiddle) {
  Mesh sphere = surfaces::icosphere(4);
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0, 0.001);  // about 1.3 % of an edge
  for (Vector3d& p : sphere.positions) p += Vector3d(noise(random), noise(random), noise(random));
  std::vector<double> mean;
  for (const auto& [k1, k2] : curvatures(sphere)) mean.push_back(0.5 * (k1 + k2));
  std::ranges::nth_element(mean, mean.begin() + static_cast<std::ptrdiff_t>(mean.size() / 2));
  EXPECT_NEAR(mean[mean.size() / 2], 1, 0.05);
}

TEST(Curvature, DoesNotChangeWithUnitPlaceOrThreads) {
  const Mesh torus = surfaces::torus(3, 1, 40, 20, 0.2);
  const auto here = curvatures(torus);
  for (const double scale : {1e-3, 1e6}) {
    const auto there = curvatures(surfaces::moved(torus, scale * Vector3d(10, -5, 3), scale));
    for (std::size_t i = 0; i < here.size(); ++i) {
      EXPECT_NEAR(there[i].k1 * scale, here[i].k1, 1e-9);
      EXPECT_NEAR(there[i].k2 * scale, here[i].k2, 1e-9);
    }
  }
}

TEST(Curvature, IsFiniteForWhatIsDegenerateAndBounded) {
  Mesh mesh = surfaces::cube();
  mesh.positions.emplace_back(9, 9, 9);                   // on no face
  mesh.positions.push_back(mesh.positions[0]);            // twice in one place
  mesh.triangles.push_back(surfaces::triangle(0, 9, 1));  // without area
  mesh.triangles.push_back(surfaces::triangle(2, 2, 3));  // without three corners
  mesh.triangles.push_back(surfaces::triangle(0, 1, 7));  // a wall within
  const auto found = curvatures(mesh);
  ASSERT_EQ(found.size(), 10U);
  for (const auto& [k1, k2] : found) {
    EXPECT_TRUE(std::isfinite(k1) && std::isfinite(k2));
    EXPECT_GE(k1, k2);
  }
  EXPECT_EQ(found[8].k1, 0);
}

TEST(Curvature, AtTheCornersOfACubeIsNoMoreThanTheMeshResolves) {
  const Mesh cube = surfaces::cube();
  const auto found = curvatures(cube);
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_GT(found[i].k2, 0.1);
    EXPECT_LE(found[i].k1, 1);  // no edge is shorter than 1
  }
}

TEST(Importance, IsOneWhereNothingIsAsked) {
  const Mesh sphere = surfaces::icosphere(1);
  EXPECT_EQ(curvature_importance(sphere, 0).value(), std::vector<double>(sphere.positions.size(), 1.0));
}

TEST(Importance, OfASphereIsTwentyFive) {
  // BBD^2 = 12 r^2 and k1^2 + k2^2 = 2 / r^2, whatever the unit.
  for (const double radius : {1e-3, 1.0, 1e6}) {
    const auto importance = curvature_importance(surfaces::icosphere(4, radius), 1).value();
    for (const double weight : importance) EXPECT_NEAR(weight, 25, 0.5);
  }
}

TEST(Importance, StopsWhenAsked) {
  std::stop_source stop;
  stop.request_stop();
  const auto importance = curvature_importance(surfaces::icosphere(1), 1, {.stop = stop.get_token()});
  ASSERT_FALSE(importance);
  EXPECT_EQ(importance.error().kind, ErrorKind::Cancelled);
}

TEST(Importance, OfAModelIsFiniteAndAtLeastOne) {
  const std::filesystem::path path = "../shared/data/meshes/elephant_24955.off";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const Mesh elephant = read_mesh(path).value();
  const auto importance = curvature_importance(elephant, 1).value();
  for (const double weight : importance) {
    ASSERT_TRUE(std::isfinite(weight));
    ASSERT_GE(weight, 1);
  }
}

}  // namespace
}  // namespace armature::sdk
