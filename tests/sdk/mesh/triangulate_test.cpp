#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>
#include <armature/sdk/mesh/triangulate.h>
#include <gtest/gtest.h>

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

std::vector<Triangle> cut(const std::vector<Vector3d>& positions) {
  std::vector<VertexId> corners;
  for (std::size_t i = 0; i < positions.size(); ++i) corners.emplace_back(i);
  std::vector<Triangle> triangles;
  triangulate_polygon(corners, positions, triangles);
  return triangles;
}

/// The sum of areas, each counted positive where it turns as the polygon's plane.
double area(const std::vector<Triangle>& triangles, const std::vector<Vector3d>& p, const Vector3d& normal) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles)
    sum += 0.5 * (p[b.index()] - p[a.index()]).cross(p[c.index()] - p[a.index()]).dot(normal);
  return sum;
}

double least_area(const std::vector<Triangle>& triangles, const std::vector<Vector3d>& p, const Vector3d& normal) {
  double least = 1e9;
  for (const Triangle& triangle : triangles) least = std::min(least, area({triangle}, p, normal));
  return least;
}

/// A star with `tips` tips: every other corner is concave.
std::vector<Vector3d> star(int tips) {
  std::vector<Vector3d> positions;
  for (int i = 0; i < 2 * tips; ++i) {
    const double angle = std::numbers::pi * i / tips;
    const double radius = i % 2 == 0 ? 1.0 : 0.2;
    positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
  }
  return positions;
}

TEST(Triangulation, CutsASquareInTwo) {
  const std::vector<Vector3d> square = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const auto triangles = cut(square);
  ASSERT_EQ(triangles.size(), 2U);
  EXPECT_NEAR(area(triangles, square, Vector3d::UnitZ()), 1, 1e-15);
}

TEST(Triangulation, AConvexPolygonIsAFanAroundItsFirstCorner) {
  const auto triangles = cut({{0, 0, 0}, {2, -1, 0}, {3, 1, 0}, {2, 3, 0}, {0, 2, 0}});
  ASSERT_EQ(triangles.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(triangles[i], (Triangle{VertexId(0), VertexId(i + 1), VertexId(i + 2)}));
}

TEST(Triangulation, ACornerOnASideMakesNoTriangleWithoutArea) {
  const std::vector<Vector3d> square = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
  EXPECT_GT(least_area(cut(square), square, Vector3d::UnitZ()), 0.5);
}

TEST(Triangulation, CutsAnArrowheadFromItsConcaveCorner) {
  // A fan from any corner but the notch and its opposite would turn a triangle over.
  for (std::size_t turned = 0; turned < 4; ++turned) {
    std::vector<Vector3d> arrow = {{0, 0, 0}, {2, 0, 0}, {0.5, 0.5, 0}, {0, 2, 0}};
    std::rotate(arrow.begin(), arrow.begin() + static_cast<std::ptrdiff_t>(turned), arrow.end());
    const auto triangles = cut(arrow);
    ASSERT_EQ(triangles.size(), 2U);
    EXPECT_GT(least_area(triangles, arrow, Vector3d::UnitZ()), 0.49);
  }
}

TEST(Triangulation, CoversAStarOnceWhicheverWayItLies) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  std::vector<Vector3d> positions = star(20);
  double expected = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    expected += 0.5 * positions[i].cross(positions[(i + 1) % positions.size()]).z();
  }
  for (Vector3d& p : positions) p = turn * p + Vector3d(100, -20, 3);
  const auto triangles = cut(positions);
  ASSERT_EQ(triangles.size(), positions.size() - 2);
  EXPECT_NEAR(area(triangles, positions, turn.col(2)), expected, 1e-12);
  EXPECT_GT(least_area(triangles, positions, turn.col(2)), 0);
}

TEST(Triangulation, GoesRoundAHoleThatABridgeJoins) {
  // A square with a square hole: the bridge's two corners stand twice in the polygon.
  const std::vector<Vector3d> positions = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0},
                                           {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}, {1, 1, 0}};
  const auto triangles = cut(positions);
  ASSERT_EQ(triangles.size(), 8U);
  EXPECT_NEAR(area(triangles, positions, Vector3d::UnitZ()), 12, 1e-12);
  EXPECT_GE(least_area(triangles, positions, Vector3d::UnitZ()), 0);
}

TEST(Triangulation, UnwindsASpiral) {
  // A band of ten turns, whose ears are rare.
  std::vector<Vector3d> band;
  constexpr int kSide = 400;
  for (int i = 0; i < 2 * kSide; ++i) {
    const bool outer = i >= kSide;
    const double turns = 10.0 * (outer ? 2 * kSide - 1 - i : i) / (kSide - 1);
    const double angle = 2 * std::numbers::pi * turns;
    const double radius = 1 + turns + (outer ? 0.3 : 0);
    band.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
  }
  const auto triangles = cut(band);
  ASSERT_EQ(triangles.size(), band.size() - 2);
  double sum = 0;
  for (const Triangle& triangle : triangles) sum += std::abs(area({triangle}, band, Vector3d::UnitZ()));
  EXPECT_NEAR(sum, -area(triangles, band, Vector3d::UnitZ()), 1e-9) << "triangles overlap";
}

TEST(Triangulation, MakesAsManyTrianglesOfWhatHasNoArea) {
  EXPECT_EQ(cut(std::vector<Vector3d>(7, Vector3d(1, 2, 3))).size(), 5U);
  EXPECT_EQ(cut({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {1.5, 0, 0}}).size(), 3U);
  // A bow tie crosses itself.
  EXPECT_EQ(cut({{0, 0, 0}, {2, 1, 0}, {2, 0, 0}, {0, 1, 0}}).size(), 2U);
}

}  // namespace
}  // namespace armature::sdk
