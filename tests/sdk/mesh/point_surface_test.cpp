#include "sdk/mesh/point_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include <Eigen/Geometry>
#include <armature/sdk/distance/measure.h>
#include <gtest/gtest.h>

#include "sdk/mesh/nearest_point.h"
#include "tests/sdk/hierarchy/shapes.h"

namespace armature::sdk {
namespace {

PointSurface joined(const PointSet& points) {
  auto surface = surface_of(points);
  EXPECT_TRUE(surface) << (surface ? "" : surface.error().message);
  return surface.value_or(PointSurface{});
}

double area_of(const PointSurface& surface) {
  return std::accumulate(surface.points.areas.begin(), surface.points.areas.end(), 0.0);
}

/// How many parts triangles and edges leave.
std::size_t parts_of(const Mesh& mesh) {
  std::vector<std::size_t> into(mesh.positions.size());
  std::iota(into.begin(), into.end(), std::size_t{0});
  const auto part = [&](std::size_t v) {
    while (into[v] != v) v = into[v];
    return v;
  };
  std::size_t parts = mesh.positions.size();
  for (const auto& [a, b, c] : mesh.triangles)
    for (const VertexId other : {b, c}) {
      if (part(a.index()) == part(other.index())) continue;
      into[part(a.index())] = part(other.index());
      --parts;
    }
  return parts;
}

/// Points of a square grid of side 1 at a height, facing up or down.
PointSet sheet(int across, double height, double up) {
  PointSet points;
  for (int i = 0; i < across; ++i)
    for (int j = 0; j < across; ++j) {
      points.positions.emplace_back((i + 0.3 * std::sin(7.0 * i + j)) / across,
                                    (j + 0.3 * std::cos(3.0 * j + i)) / across, height);
      points.normals.emplace_back(0, 0, up);
    }
  return points;
}

PointSet together(PointSet a, const PointSet& b) {
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  a.normals.insert(a.normals.end(), b.normals.begin(), b.normals.end());
  return a;
}

TEST(NearestPoint, FindsTheClosestFewInOrder) {
  std::mt19937 random(3);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 500; ++i) points.emplace_back(random() % 8, random() % 8, random() % 8);  // many equally far
  const NearestPoint tree(points);
  for (std::uint32_t i = 0; i < points.size(); i += 7) {
    std::array<NearestPoint::Found, 12> found;
    ASSERT_EQ(tree.find(points[i], found, i), found.size());
    std::vector<std::pair<double, std::uint32_t>> all;
    for (std::uint32_t k = 0; k < points.size(); ++k)
      if (k != i) all.emplace_back((points[k] - points[i]).squaredNorm(), k);
    std::ranges::sort(all);
    for (std::size_t k = 0; k < found.size(); ++k) EXPECT_EQ(found[k].point, all[k].second);
  }
  std::array<NearestPoint::Found, 12> found;
  EXPECT_EQ(NearestPoint({{0, 0, 0}, {1, 0, 0}}).find({0, 0, 0}, found, 0), 1U);
}

TEST(PointSurface, KnowsTheAreaOfABall) {
  const PointSurface surface = joined(sample_points(ball(5), 4000));
  EXPECT_NEAR(area_of(surface), 4 * std::numbers::pi, 0.02 * 4 * std::numbers::pi);
  EXPECT_EQ(parts_of(surface.mesh), 1U);
  // Triangles cover it about once and face outward.
  double covered = 0;
  for (const Triangle& t : surface.mesh.triangles) {
    const Eigen::Vector3d& a = surface.mesh.position(t[0]);
    const Eigen::Vector3d cross = (surface.mesh.position(t[1]) - a).cross(surface.mesh.position(t[2]) - a);
    EXPECT_GE(cross.dot(a), 0);
    covered += 0.5 * cross.norm();
  }
  EXPECT_NEAR(covered, 4 * std::numbers::pi, 0.1 * 4 * std::numbers::pi);
}

TEST(PointSurface, KeepsWhatLiesBeyondAGapApart) {
  // Two sheets that face each other across less than the distance of their points.
  EXPECT_EQ(parts_of(joined(together(sheet(20, 0, 1), sheet(20, 0.02, -1))).mesh), 2U);
  EXPECT_EQ(parts_of(joined(together(sheet(20, 0, 1), sheet(20, 3, 1))).mesh), 2U);
}

TEST(PointSurface, JoinsTheSidesOfASheetByOneEdge) {
  const PointSurface surface = joined(together(sheet(20, 0, -1), sheet(20, 0.02, 1)));
  EXPECT_EQ(parts_of(surface.mesh), 1U);
  std::set<std::array<std::size_t, 2>> across;
  for (const Triangle& t : surface.mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t a = t[k].index(), b = t[(k + 1) % 3].index();
      if ((a < 400) != (b < 400)) across.insert({std::min(a, b), std::max(a, b)});
    }
  EXPECT_EQ(across.size(), 1U);
}

TEST(PointSurface, SharesACellAtOnePlace) {
  PointSet points = sheet(10, 0, 1);
  const double before = area_of(joined(points));
  points.positions.push_back(points.positions[44]);
  points.normals.push_back(points.normals[44]);
  const PointSurface surface = joined(points);
  EXPECT_NEAR(area_of(surface), before, 1e-12);
  EXPECT_EQ(surface.points.areas[44], surface.points.areas[100]);
  EXPECT_EQ(parts_of(surface.mesh), 1U);
}

TEST(PointSurface, GivesALonePointNoLargePart) {
  PointSet points = sheet(20, 0, 1);
  const double before = area_of(joined(points));
  points.positions.emplace_back(0.5, 0.5, 5);
  points.normals.emplace_back(1, 0, 0);
  EXPECT_LT(joined(points).points.areas.back(), 0.05 * before);
}

TEST(PointSurface, KeepsAreasThatAreGiven) {
  PointSet points = sheet(10, 0, 1);
  points.areas.assign(100, 2);
  EXPECT_EQ(joined(points).points.areas, points.areas);
}

TEST(PointSurface, IsTheSameAtAnySizeAndPlace) {
  const PointSet points = sample_points(ball(4), 500);
  PointSet moved = points;
  for (auto& p : moved.positions) p = 1024 * p + Eigen::Vector3d(4096, 0, 0);
  const PointSurface a = joined(points);
  const PointSurface b = joined(moved);
  EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
  for (std::size_t i = 0; i < a.points.areas.size(); ++i)
    EXPECT_NEAR(b.points.areas[i], 1024.0 * 1024 * a.points.areas[i], 1e-6 * b.points.areas[i]);
}

TEST(PointSurface, RefusesWhatItCannotJoin) {
  EXPECT_FALSE(surface_of(PointSet{}));
  PointSet points = sheet(3, 0, 1);
  for (auto& n : points.normals) n.setZero();
  ASSERT_FALSE(surface_of(points));
  EXPECT_EQ(surface_of(points).error().message, "expected points with normals; all normals are 0 0 0");
  points = sheet(3, 0, 1);
  points.normals[4].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(surface_of(points));
  points = sheet(3, 0, 1);
  points.positions[4].x() = 1e300;
  EXPECT_EQ(surface_of(points).error().message,
            "expected points that lie closer together; the area of their box is beyond all numbers");
  for (const double scale : {1e-160, 1e-300}) {
    points = sheet(3, 0, 1);
    for (auto& p : points.positions) p *= scale;
    EXPECT_EQ(surface_of(points).error().message,
              "expected points that lie farther apart; the area of their box is below all numbers");
  }
}

TEST(PointSurface, RefusesAreasThatCannotBeThoseOfPointsSoFarApart) {
  PointSet points = sheet(10, 0, 1);
  for (const double area : {0.0, 1e-320, 1e-20, 1e20, 1e80, 1e308}) {
    points.areas.assign(100, area);
    const auto surface = surface_of(points);
    ASSERT_FALSE(surface) << area;
    EXPECT_EQ(surface.error().message,
              "areas: expected what fits the points' places; all together they are 0, or more than 1e12 times smaller "
              "or larger than the square of the diagonal of the points' box");
  }
  for (const double area : {1e-13, 1e-2, 1e10}) {
    points.areas.assign(100, area);
    EXPECT_TRUE(surface_of(points)) << area;
  }
  // Those without a normal count for nothing.
  points.normals[0].setZero();
  points.areas.assign(100, 0);
  points.areas[0] = 1;
  EXPECT_FALSE(surface_of(points));
}

TEST(PointSurface, JoinsPointsWithNormalsOfAnyLength) {
  const PointSet points = sheet(10, 0, 1);
  PointSet longer = points;
  for (auto& n : longer.normals) n = Eigen::Vector3d(1e308, 1e308, 1.7e308);
  for (const auto& n : joined(longer).points.normals) EXPECT_NEAR(n.norm(), 1, 1e-15);
  for (const double length : {1e308, 5e-324}) {
    for (std::size_t i = 0; i < points.normals.size(); ++i) longer.normals[i] = length * points.normals[i];
    EXPECT_EQ(joined(longer).points.normals, joined(points).points.normals);
    EXPECT_EQ(joined(longer).mesh.triangles, joined(points).mesh.triangles);
  }
}

TEST(PointSurface, TakesPointsAtOnePlaceAndFew) {
  for (const std::size_t count : {1U, 2U, 3U, 40U}) {
    PointSet points;
    points.positions.assign(count, Eigen::Vector3d(1, 2, 3));
    points.normals.assign(count, Eigen::Vector3d(0, 0, 2));
    EXPECT_EQ(joined(points).mesh.triangles.size(), count - 1);
    for (std::size_t i = 0; i < count; ++i) points.positions[i].x() = static_cast<double>(i);
    EXPECT_EQ(joined(points).mesh.positions.size(), count);
  }
}

}  // namespace
}  // namespace armature::sdk
