#include "tools/evaluation/shapes.h"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace armature::tools {
namespace {

double volume(const sdk::Mesh& mesh) {
  double sum = 0;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const sdk::FaceId face(f);
    sum += mesh.corner(face, 0).dot(mesh.corner(face, 1).cross(mesh.corner(face, 2))) / 6;
  }
  return sum;
}

TEST(Shapes, AnIcosphereTendsToASphereWithItsFacesOutward) {
  const sdk::Mesh mesh = icosphere(4, 2);
  EXPECT_EQ(mesh.triangles.size(), 20U << 8U);
  EXPECT_EQ(mesh.positions.size(), 2 + mesh.triangles.size() / 2);  // Euler's formula
  EXPECT_NEAR(volume(mesh) / (4 * std::numbers::pi * 8 / 3), 1, 0.01);
}

TEST(Shapes, AHollowBallHasTheVolumeOfItsWall) {
  const double whole = volume(icosphere(3));
  EXPECT_NEAR(volume(hollow_ball(3, 0.5)), whole * (1 - 0.125), 1e-9);
}

TEST(Shapes, ATubeIsClosedWithItsFacesOutwardHoweverItIsTwisted) {
  for (const double twist : {0.0, 0.5}) {
    const sdk::Mesh mesh = straight_tube(6, 48, twist);
    EXPECT_EQ(mesh.positions.size(), 2 + mesh.triangles.size() / 2);  // Euler's formula
    EXPECT_NEAR(volume(mesh) / (std::numbers::pi * (6 + 4.0 / 3)), 1, 0.01);
  }
}

TEST(Shapes, CuttingFacesInFourLeavesTheSurface) {
  const sdk::Mesh mesh = creature(3);
  const sdk::Mesh finer = subdivided(mesh);
  EXPECT_EQ(finer.triangles.size(), 4 * mesh.triangles.size());
  EXPECT_EQ(finer.positions.size(), 2 + finer.triangles.size() / 2);
  EXPECT_NEAR(volume(finer), volume(mesh), 1e-9);
}

TEST(Shapes, NoiseIsBoundedAndTheSameForTheSameSeed) {
  const sdk::Mesh mesh = icosphere(3);
  const sdk::Mesh noisy = with_noise(mesh, 1, 7);
  const sdk::Mesh again = with_noise(mesh, 1, 7);
  const double diagonal = 2 * std::sqrt(3.0);
  double most = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    most = std::max(most, (noisy.positions[v] - mesh.positions[v]).norm());
    EXPECT_EQ(noisy.positions[v], again.positions[v]);
  }
  EXPECT_LE(most, 0.0101 * diagonal);
  EXPECT_GT(most, 0.009 * diagonal);
}

TEST(Shapes, HalfAShapeKeepsOnlyTheVerticesItUses) {
  const sdk::Mesh half = half_of(icosphere(3));
  EXPECT_NEAR(static_cast<double>(half.triangles.size()), 20 * 64 / 2.0, 64);
  EXPECT_LT(half.positions.size(), half.triangles.size());
}

}  // namespace
}  // namespace armature::tools
