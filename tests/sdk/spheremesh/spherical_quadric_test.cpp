#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>
#include <armature/sdk/spheremesh/spherical_quadric.h>
#include <gtest/gtest.h>

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

struct OrientedPoint {
  Vector3d point, normal;
};

SphericalQuadric sum_of(const std::vector<OrientedPoint>& planes) {
  SphericalQuadric quadric;
  for (const auto& [point, normal] : planes) quadric += SphericalQuadric::of_plane(point, normal);
  return quadric;
}

double squared_distances(const std::vector<OrientedPoint>& planes, const Sphere& sphere) {
  double sum = 0;
  for (const auto& [point, normal] : planes) sum += std::pow(normal.dot(point - sphere.centre) - sphere.radius, 2);
  return sum;
}

std::vector<OrientedPoint> on_sphere(const Sphere& sphere, const Vector3d& towards = Vector3d::Zero()) {
  std::vector<OrientedPoint> planes;
  for (int i = 0; i < 12; ++i)
    for (int j = 1; j < 8; ++j) {
      const double a = i * std::numbers::pi / 6, b = j * std::numbers::pi / 8;
      const Vector3d n(std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), std::cos(b));
      if (n.dot(towards) >= 0) planes.push_back({sphere.centre + sphere.radius * n, n});
    }
  return planes;
}

/// The least of many spheres about `near`, in the domain.
double least_by_search(const std::vector<OrientedPoint>& planes, const Sphere& near, double max_radius, double step) {
  double least = squared_distances(planes, near);
  for (int x = -4; x <= 4; ++x)
    for (int y = -4; y <= 4; ++y)
      for (int z = -4; z <= 4; ++z)
        for (int r = -4; r <= 4; ++r) {
          const double radius = std::clamp(near.radius + r * step, 0.0, max_radius);
          least = std::min(least, squared_distances(planes, {near.centre + step * Vector3d(x, y, z), radius}));
        }
  return least;
}

TEST(SphericalQuadric, IsTheSumOfSquaredSignedDistancesToPlanes) {
  const auto planes = on_sphere({{1, 2, 3}, 0.5});
  const Sphere sphere{{0.8, 2.1, 3.3}, 0.7};
  EXPECT_NEAR(sum_of(planes)(sphere), squared_distances(planes, sphere), 1e-9);
  const Eigen::Vector4d s(0.8, 2.1, 3.3, 0.7);
  const auto quadric = sum_of(planes);
  EXPECT_NEAR(
      0.5 * s.dot(quadric.matrix() * s) - Eigen::Map<const Eigen::Vector4d>(quadric.b.data()).dot(s) + quadric.c,
      quadric(sphere), 1e-9);
}

TEST(SphericalQuadric, MovesWithItsPlanes) {
  const auto planes = on_sphere({{1, 2, 3}, 0.5});
  const Vector3d offset(-1, 0.5, 2);
  const Sphere sphere{{0.8, 2.1, 3.3}, 0.7};
  EXPECT_NEAR(sum_of(planes).translated(offset)({sphere.centre + offset, sphere.radius}), sum_of(planes)(sphere), 1e-9);
}

TEST(SphericalQuadric, SpreadOverATriangleIsItsIntegral) {
  const std::array<Vector3d, 3> corners{Vector3d(0, 0, 0), Vector3d(2, 0, 1), Vector3d(0, 3, -1)};
  const double area = 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm();
  const Vector3d q(0.3, -0.4, 1);
  // Midpoints of the edges integrate quadratic functions exactly.
  double expected = 0;
  for (std::size_t k = 0; k < 3; ++k)
    expected += 0.25 * area / 3 * (q - 0.5 * (corners[k] + corners[(k + 1) % 3])).squaredNorm();
  EXPECT_NEAR(SphericalQuadric::of_triangle_spread(corners, 0.25)({q, 5}), expected, 1e-12);
}

TEST(SphereFit, FindsTheSphereThatItsTangentPlanesTouch) {
  for (const double scale : {1e-3, 1.0, 1e6}) {
    const Sphere truth{scale * Vector3d(0.1, -0.2, 0.3), scale * 0.4};
    const auto fit = minimise(sum_of(on_sphere(truth)), {.max_radius = scale});
    EXPECT_EQ(fit.found, FitCase::Interior);
    EXPECT_NEAR((fit.sphere.centre - truth.centre).norm(), 0, 1e-9 * scale);
    EXPECT_NEAR(fit.sphere.radius, truth.radius, 1e-9 * scale);
    EXPECT_NEAR(fit.cost, 0, 1e-12 * scale * scale);
  }
}

TEST(SphereFit, KeepsToTheLargestRadius) {
  const auto planes = on_sphere({{0.1, -0.2, 0.3}, 0.4}, {0, 0, 1});
  const auto fit = minimise(sum_of(planes), {.max_radius = 0.3});
  EXPECT_EQ(fit.found, FitCase::AtRadius);
  EXPECT_EQ(fit.sphere.radius, 0.3);
  EXPECT_GT(fit.sphere.centre.z(), 0.3);
  EXPECT_NEAR(fit.cost, squared_distances(planes, fit.sphere), 1e-12);
  EXPECT_LE(fit.cost, least_by_search(planes, fit.sphere, 0.3, 1e-3) + 1e-12);
}

TEST(SphereFit, IsAPointInAConcavity) {
  // A ball-shaped dent: the normals point to its middle.
  auto planes = on_sphere({{0, 0, 0}, 1}, {0, 0, -1});
  for (auto& plane : planes) plane.normal = -plane.normal;
  const auto fit = minimise(sum_of(planes), {.max_radius = 10});
  EXPECT_EQ(fit.found, FitCase::AtRadius);
  EXPECT_EQ(fit.sphere.radius, 0);
  EXPECT_NEAR(fit.cost, squared_distances(planes, fit.sphere), 1e-12);
  EXPECT_LE(fit.cost, least_by_search(planes, fit.sphere, 10, 1e-3) + 1e-12);
}

TEST(SphereFit, OnACornerTakesTheSpheresThatTouchItsPlanes) {
  // Three planes are touched by a line of spheres, so the segment decides.
  const auto quadric = sum_of({{{1, 0, 0}, {1, 0, 0}}, {{0, 1, 0}, {0, 1, 0}}, {{0, 0, 1}, {0, 0, 1}}});
  const auto fit = minimise(quadric, {.from = {1, 1, 1}, .to = {1, 1, 0}, .max_radius = 0.5});
  EXPECT_EQ(fit.found, FitCase::OnSegment);
  EXPECT_NEAR((fit.sphere.centre - Vector3d(1, 1, 1)).norm(), 0, 1e-9);
  EXPECT_NEAR(fit.sphere.radius, 0, 1e-9);
}

TEST(SphereFit, OnACylinderLiesOnTheSegmentWithTheCylindersRadius) {
  for (const double scale : {1e-3, 1.0, 1e6}) {
    std::vector<OrientedPoint> planes;
    for (int k = 0; k < 24; ++k) {
      const Vector3d n(std::cos(k * std::numbers::pi / 12), std::sin(k * std::numbers::pi / 12), 0);
      planes.push_back({scale * (0.5 * n + Vector3d(0, 0, 0.1 * k)), n});
    }
    const auto fit = minimise(
        sum_of(planes), {.from = scale * Vector3d(0.5, 0, 1), .to = scale * Vector3d(-0.5, 0, 2), .max_radius = scale});
    EXPECT_EQ(fit.found, FitCase::OnSegment);
    EXPECT_NEAR((fit.sphere.centre - scale * Vector3d(0, 0, 1.5)).norm(), 0, 1e-9 * scale);
    EXPECT_NEAR(fit.sphere.radius, 0.5 * scale, 1e-9 * scale);
  }
}

TEST(SphereFit, OnASharpEdgeStaysOnTheSegment) {
  const auto quadric = sum_of({{{0, 1, 0}, {0, 1, 0}}, {{0, 0, 1}, {0, 0, 1}}});
  const auto along = minimise(quadric, {.from = {0, 1, 1}, .to = {4, 1, 1}, .max_radius = 0.2});
  EXPECT_EQ(along.found, FitCase::AtMidpoint);
  EXPECT_NEAR((along.sphere.centre - Vector3d(2, 1, 1)).norm(), 0, 1e-9);
  EXPECT_NEAR(along.sphere.radius, 0, 1e-9);
  const auto across = minimise(quadric, {.from = {0, 1, 1}, .to = {0, 1, 0}, .max_radius = 0.2});
  EXPECT_EQ(across.found, FitCase::OnSegment);
  EXPECT_NEAR(across.cost, 0, 1e-12);
}

TEST(SphereFit, OnAPlaneIsAPointAtTheMiddleOfTheSegment) {
  for (const double scale : {1e-3, 1.0, 1e6}) {
    const Vector3d n = Vector3d(1, 2, -1).normalized();
    std::vector<OrientedPoint> planes;
    for (int k = 0; k < 5; ++k) planes.push_back({scale * n, n});
    const Vector3d along = n.unitOrthogonal();
    const auto fit =
        minimise(sum_of(planes), {.from = scale * n, .to = scale * (n + along), .max_radius = 0.5 * scale});
    EXPECT_EQ(fit.found, FitCase::AtMidpoint);
    EXPECT_NEAR((fit.sphere.centre - scale * (n + 0.5 * along)).norm(), 0, 1e-9 * scale);
    EXPECT_NEAR(fit.sphere.radius, 0, 1e-9 * scale);
  }
}

TEST(SphereFit, WithoutPlanesIsAPoint) {
  const auto fit = minimise({}, {.from = {0, 0, 0}, .to = {2, 0, 0}, .max_radius = 1});
  EXPECT_EQ(fit.sphere.radius, 0);
  EXPECT_EQ(fit.cost, 0);
  EXPECT_NEAR((fit.sphere.centre - Vector3d(1, 0, 0)).norm(), 0, 1e-12);
}

TEST(SphereFit, WithTheSpreadOfItsRegionIsDeterminedOnAPlane) {
  const std::array<Vector3d, 3> corners{Vector3d(0, 0, 1), Vector3d(3, 0, 1), Vector3d(0, 3, 1)};
  auto quadric = SphericalQuadric::of_plane({0, 0, 1}, {0, 0, 1}, 4.5);
  quadric += SphericalQuadric::of_triangle_spread(corners, 1e-4);
  const auto fit = minimise(quadric, {.max_radius = 1, .pivot = 0});
  EXPECT_NEAR((fit.sphere.centre - Vector3d(1, 1, 1)).norm(), 0, 1e-6);
  EXPECT_NEAR(fit.sphere.radius, 0, 1e-6);
}

}  // namespace
}  // namespace armature::sdk
