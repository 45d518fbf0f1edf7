#include <cmath>
#include <random>

#include <Eigen/Geometry>
#include <armature/sdk/distance/outer_surface.h>
#include <gtest/gtest.h>

#include "tests/support/count_allocations.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

SphereMesh balls(std::vector<Sphere> spheres) {
  SphereMesh shape;
  shape.spheres = std::move(spheres);
  return shape;
}

/// Askew, so that no wall lies as the grid of voids does.
const Eigen::Matrix3d kAskew = Eigen::AngleAxisd(0.4, Vector3d(1, 2, 3).normalized()).toRotationMatrix();

/// A random connected shape, with triangles and wire edges that meet and cross.
SphereMesh tangle(std::size_t spheres, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  SphereMesh shape;
  for (std::size_t k = 0; k < spheres; ++k)
    shape.spheres.push_back({{u(random), u(random), 0.6 * u(random)}, 0.1 + 0.2 * std::abs(u(random))});
  for (std::size_t k = 0; k + 3 < spheres; k += 3) {
    shape.triangles.push_back({SphereId(k), SphereId(k + 1), SphereId(k + 2)});
    shape.triangles.push_back({SphereId(k + 1), SphereId(k + 2), SphereId(k + 3)});
    if (k + 5 < spheres) shape.edges.push_back({SphereId(k), SphereId(k + 5)});
  }
  return shape;
}

/// Spheres at the corners of a cube with the twelve triangles of its sides: a thick box around a void.
SphereMesh hollow_box(double radius) {
  SphereMesh shape;
  for (int k = 0; k < 8; ++k)
    shape.spheres.push_back({{k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? 1.0 : -1.0}, radius});
  for (const auto& [a, b, c, d] : std::vector<std::array<int, 4>>{
           {0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 4, 5}, {2, 3, 6, 7}, {0, 2, 4, 6}, {1, 3, 5, 7}}) {
    shape.triangles.push_back({SphereId(a), SphereId(b), SphereId(c)});
    shape.triangles.push_back({SphereId(b), SphereId(c), SphereId(d)});
  }
  std::sort(shape.triangles.begin(), shape.triangles.end());
  return shape;
}

TEST(OuterSurface, BetweenTwoBallsTheNearestSurfaceIsTheirCrease) {
  const OuterSurface surface(balls({{{-0.5, 0, 0}, 1}, {{0.5, 0, 0}, 1}}));
  EXPECT_NEAR(surface.signed_distance({0, 0, 0}), -std::sqrt(0.75), 1e-5);
  EXPECT_NEAR(surface.signed_distance({-0.5, 0, 0.1}), -0.9, 1e-5);
  EXPECT_NEAR(surface.signed_distance({3, 0, 0}), 1.5, 1e-12);
}

TEST(OuterSurface, WhereThreeBallsMeetTheNearestSurfaceIsTheirCorner) {
  const double s = std::sqrt(0.75);
  const OuterSurface surface(balls({{{-0.5, 0, 0}, 0.7}, {{0.5, 0, 0}, 0.7}, {{0, s, 0}, 0.7}}));
  const double to_middle2 = 1.0 / 3;
  EXPECT_NEAR(surface.signed_distance({0, s / 3, 0}), -std::sqrt(0.49 - to_middle2), 1e-5);
}

TEST(OuterSurface, OfOneConvexPrimitiveItsOwnDistanceIsTheDistance) {
  SphereMesh shape = balls({{{0, 0, 0}, 0.6}, {{2, 0, 0}, 0.5}, {{0, 1.5, 0}, 0.3}});
  shape.triangles = {{SphereId(0), SphereId(1), SphereId(2)}};
  const OuterSurface surface(shape);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> u(-1, 2.5);
  for (int k = 0; k < 2000; ++k) {
    const Vector3d p{u(random), u(random), u(random) / 3};
    EXPECT_NEAR(surface.signed_distance(p),
                signed_distance(SphereTriangle{shape.spheres[0], shape.spheres[1], shape.spheres[2]}, p), 1e-9);
  }
}

/// Nothing of the surface is nearer than the distance says, and something is as near.
void expect_distances_to_samples(const SphereMesh& shape, unsigned seed) {
  const OuterSurface surface(shape);
  ASSERT_FALSE(surface.has_cavities());
  const auto samples = surface.sample(30000);
  ASSERT_GT(samples.size(), 20000U);
  const auto [lower, upper] = surface.tree().bounds();
  const double diagonal = (upper - lower).norm();
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(0, 1);
  int inside = 0;
  for (int k = 0; k < 4000 && inside < 200; ++k) {
    const Vector3d p = lower + Vector3d(u(random), u(random), u(random)).cwiseProduct(upper - lower);
    const double distance = surface.signed_distance(p);
    if (distance >= 0) continue;
    ++inside;
    double nearest = 1e9;
    for (const OuterSample& s : samples) nearest = std::min(nearest, (s.point - p).norm());
    for (const OuterCrease& c : surface.creases()) nearest = std::min(nearest, (c.a - p).norm());
    EXPECT_GE(nearest, -distance - 2e-6 * diagonal);
    EXPECT_LE(nearest, -distance + 0.01 * diagonal);
  }
  EXPECT_GE(inside, 100);
}

TEST(OuterSurface, OfATangleNoSampleIsNearerAndOneAsNear) {
  expect_distances_to_samples(tangle(9, 8), 2);
  expect_distances_to_samples(tangle(9, 5), 4);
}

TEST(OuterSurface, SamplesLieOnTheSurfaceAndKnowTheirSpheres) {
  const SphereMesh shape = tangle(12, 5);
  const OuterSurface surface(shape);
  for (const OuterSample& s : surface.sample(5000)) {
    EXPECT_NEAR(surface.tree().signed_distance(s.point), 0, 1e-6);
    EXPECT_NEAR(s.normal.norm(), 1, 1e-12);
    Sphere blended;
    for (std::size_t k = 0; k < 3; ++k)
      if (s.spheres[k].valid()) {
        blended.centre += s.weights[static_cast<Eigen::Index>(k)] * shape.sphere(s.spheres[k]).centre;
        blended.radius += s.weights[static_cast<Eigen::Index>(k)] * shape.sphere(s.spheres[k]).radius;
      }
    EXPECT_NEAR((blended.centre + blended.radius * s.normal - s.point).norm(), 0, 1e-12);
  }
}

TEST(OuterSurface, SamplesAreSpreadByArea) {
  // A capsule of radius 1 and length 2: half its area of 8 pi is the cylinder's.
  SphereMesh shape = balls({{{0, 0, 0}, 1}, {{2, 0, 0}, 1}});
  shape.edges = {{SphereId(0), SphereId(1)}};
  const auto samples = OuterSurface(shape).sample(20000);
  const auto on_side = std::count_if(samples.begin(), samples.end(),
                                     [](const OuterSample& s) { return s.point.x() > 0 && s.point.x() < 2; });
  EXPECT_NEAR(static_cast<double>(on_side) / static_cast<double>(samples.size()), 0.5, 0.005);
}

TEST(OuterSurface, AClosedVoidIsTakenForFilled) {
  const OuterSurface surface(hollow_box(0.2));
  EXPECT_TRUE(surface.has_cavities());
  EXPECT_NEAR(surface.signed_distance({0, 0, 0}), -1.2, 1e-5);
  EXPECT_NEAR(surface.signed_distance({0, 0, 0.75}), -0.45, 1e-5);
  EXPECT_NEAR(surface.signed_distance({0, 0, 1.5}), 0.3, 1e-9);
  for (const OuterSample& s : surface.sample(5000)) EXPECT_GT(s.point.cwiseAbs().maxCoeff(), 0.99);
}

TEST(OuterSurface, AnOpenVoidIsOutside) {
  SphereMesh open = hollow_box(0.2);
  open.triangles.erase(open.triangles.begin(), open.triangles.begin() + 1);
  const OuterSurface surface(open);
  EXPECT_FALSE(surface.has_cavities());
  EXPECT_GT(surface.signed_distance({0, 0, 0}), 0.7);
}

TEST(OuterSurface, PointsWithoutRadiusAreAMesh) {
  const OuterSurface surface(hollow_box(0));
  EXPECT_NEAR(surface.signed_distance({0.2, 0.1, 3}), 2, 1e-12);
  EXPECT_TRUE(std::isfinite(surface.signed_distance({0.2, 0.1, 0.5})));
}

/// Points without radius and triangles: an L of arms that are 1 thick and 1 high.
SphereMesh ell() {
  SphereMesh shape;
  const std::vector<Vector3d> outline = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
  for (const double z : {0.0, 1.0})
    for (const Vector3d& corner : outline) shape.spheres.push_back({kAskew * (corner + z * Vector3d::UnitZ()), 0});
  const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
    std::array<std::size_t, 3> sorted = {a, b, c};
    std::ranges::sort(sorted);
    shape.triangles.push_back({SphereId(sorted[0]), SphereId(sorted[1]), SphereId(sorted[2])});
  };
  for (std::size_t k = 0; k < 6; ++k) {
    add(k, (k + 1) % 6, k + 6);
    add((k + 1) % 6, k + 6, (k + 1) % 6 + 6);
  }
  for (const std::size_t end : {0, 6}) {
    add(end, end + 1, end + 3);
    add(end + 1, end + 2, end + 3);
    add(end, end + 3, end + 5);
    add(end + 3, end + 4, end + 5);
  }
  std::ranges::sort(shape.triangles);
  return shape;
}

TEST(OuterSurface, FromWithinALineWithoutThicknessIsSurfaceToo) {
  const OuterSurface surface(ell());
  ASSERT_TRUE(surface.has_cavities());
  EXPECT_NEAR(surface.signed_distance(kAskew * Vector3d(0.9, 0.8, 0.5)), -std::hypot(0.1, 0.2), 1e-9)
      << "the edge between the arms";
  EXPECT_NEAR(surface.signed_distance(kAskew * Vector3d(0.3, 1.5, 0.5)), -0.3, 1e-9);
}

TEST(OuterSurface, ThinWallsAroundAVoidHideWhatIsWithin) {
  // A wedge of walls a twelfth of a cell thick, near whose edge a cell ahead of the one wall is beyond the other.
  constexpr double kRadius = 2e-4, kHalfAngle = 0.15;
  SphereMesh shape;
  for (const double z : {-0.5, 0.5})
    for (const Vector3d& corner :
         {Vector3d(0, 0, z), Vector3d(1, std::tan(kHalfAngle), z), Vector3d(1, -std::tan(kHalfAngle), z)})
      shape.spheres.push_back({kAskew * corner, kRadius});
  for (const auto& [a, b, c] : std::vector<std::array<int, 3>>{
           {0, 1, 2}, {3, 4, 5}, {0, 1, 3}, {1, 3, 4}, {1, 2, 4}, {2, 4, 5}, {0, 2, 3}, {2, 3, 5}})
    shape.triangles.push_back({SphereId(a), SphereId(b), SphereId(c)});
  const OuterSurface surface(shape);
  ASSERT_TRUE(surface.has_cavities());
  for (double x = 0.005; x < 0.3; x += 0.005)
    EXPECT_NEAR(surface.signed_distance(kAskew * Vector3d(x, 0, 0)), -(x * std::sin(kHalfAngle) + kRadius), 1e-6) << x;
}

TEST(OuterSurface, CreasesThatAreTracedWhenAskedLieWhereTheyWouldBeFoundBefore) {
  for (const SphereMesh& shape : {tangle(12, 5), tangle(30, 3), hollow_box(0.2), hollow_box(0), ell()}) {
    const OuterSurface found(shape), traced(shape, {.creases_when_asked = true});
    EXPECT_TRUE(traced.creases().empty());
    const auto [lower, upper] = found.tree().bounds();
    std::mt19937 random(7);
    std::uniform_real_distribution<double> u(0, 1);
    for (int k = 0; k < 300; ++k) {
      const Vector3d p = lower + Vector3d(u(random), u(random), u(random)).cwiseProduct(upper - lower);
      EXPECT_NEAR(traced.signed_distance(p), found.signed_distance(p), 4e-6 * (upper - lower).norm());
    }
  }
}

TEST(OuterSurface, IsNotBuiltOnceItIsCancelled) {
  // A chain of balls, each with creases to find; stopped at the first word of them.
  SphereMesh shape;
  for (int i = 0; i < 400; ++i) shape.spheres.push_back({{0.5 * i, 0, 0}, 0.5});
  std::stop_source stop;
  std::size_t told = 0;
  const Task task{.stop = stop.get_token(), .progress = [&](std::string_view stage, double) {
                    told += stage == "finding creases" ? 1 : 0;
                    if (told > 0) stop.request_stop();
                  }};
  const auto surface = OuterSurface::build(shape, {.cavity_grid = 32}, task);
  ASSERT_FALSE(surface);
  EXPECT_EQ(surface.error().kind, ErrorKind::Cancelled);
  EXPECT_EQ(told, 1U) << "of two blocks";
  EXPECT_GT(OuterSurface::build(shape, {.cavity_grid = 32}, {})->creases().size(), 400U);
}

TEST(OuterSurface, WithoutMemoryQueriesThrowWhatCanBeCaught) {
  const SphereMesh shape = balls({{{0, 0, 0}, 1}, {{1, 0, 0}, 1}});
  const OuterSurface traced(shape, {.creases_when_asked = true});
  const Vector3d between(0.5, 0.1, 0);
  const auto without_memory = [](const auto& query) {
    test::out_of_memory = true;
    try {
      query();
    } catch (...) {
      test::out_of_memory = false;
      throw;
    }
    test::out_of_memory = false;
  };
  EXPECT_THROW(without_memory([&] { (void)traced.signed_distance(between); }), std::bad_alloc);
  EXPECT_THROW(without_memory([&] { (void)traced.tree().intersect({between, Vector3d::UnitX()}); }), std::bad_alloc);
  // What is noexcept takes none.
  without_memory([&] { EXPECT_LT(traced.tree().nearest(between).distance, 0); });
}

TEST(OuterSurface, WithoutSpheresThereIsNothing) {
  const OuterSurface surface(SphereMesh{});
  EXPECT_TRUE(std::isinf(surface.signed_distance({0, 0, 0})));
  EXPECT_TRUE(surface.sample(100).empty());
}

}  // namespace
}  // namespace armature::sdk
