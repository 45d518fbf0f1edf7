#include <cmath>
#include <random>

#include <Eigen/Geometry>
#include <armature/sdk/spheremesh/primitives.h>
#include <gtest/gtest.h>

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

constexpr double kExact = 1e-12;  // of unit-sized shapes

SphereEdge cone() {
  return {{{0, 0, 0}, 1.0}, {{4, 0, 0}, 0.5}};
}

/// Distance by brute force: the smallest over many interpolated spheres.
double sampled_distance(const SphereEdge& edge, const Vector3d& point) {
  double least = 1e9;
  for (int i = 0; i <= 20000; ++i) least = std::min(least, signed_distance(interpolated(edge, i / 20000.0), point));
  return least;
}

TEST(Sphere, ARayAlongAnAxisMeetsItAtItsRadius) {
  const auto hit = intersect(Sphere{{0, 0, 5}, 2}, {{0, 0, 0}, {0, 0, 1}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->t, 3, kExact);
}

TEST(Sphere, ARayWithALongDirectionCountsInItsLengths) {
  const auto hit = intersect(Sphere{{0, 0, 5}, 2}, {{0, 0, 0}, {0, 0, 2}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->t, 1.5, kExact);
}

TEST(Sphere, BehindTheOriginThereIsNothing) {
  EXPECT_FALSE(intersect(Sphere{{0, 0, -5}, 2}, {{0, 0, 0}, {0, 0, 1}}));
}

TEST(SphereEdge, TheSideIsTangentToBothSpheres) {
  const SphereEdge edge = cone();
  // sin of the half angle is (1 - 0.5) / 4: the contact circle of sphere a lies at x = 1/8, radius sqrt(1 - 1/64).
  const double radius = std::sqrt(1 - 1.0 / 64);
  EXPECT_NEAR(signed_distance(edge, {0.125, radius, 0}), 0, kExact);
  const auto hit = intersect(edge, {{0.125, 5, 0}, {0, -1, 0}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(5 - hit->t, radius, kExact);
  // Right of it the ray meets the cone, whose height falls linearly.
  const auto middle = intersect(edge, {{2, 5, 0}, {0, -1, 0}});
  ASSERT_TRUE(middle);
  const double slope = -0.125 / std::sqrt(1 - 1.0 / 64);
  EXPECT_NEAR(5 - middle->t, radius + slope * (2 - 0.125), kExact);
}

TEST(SphereEdge, RayAlongTheAxisEntersThroughTheCap) {
  const auto hit = intersect(cone(), {{-10, 0, 0}, {1, 0, 0}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->t, 9, kExact);
  EXPECT_EQ(hit->blend, 0);
  const auto from_behind = intersect(cone(), {{10, 0, 0}, {-1, 0, 0}});
  ASSERT_TRUE(from_behind);
  EXPECT_NEAR(from_behind->t, 5.5, kExact);
  EXPECT_EQ(from_behind->blend, 1);
}

TEST(SphereEdge, FromInsideTheExitIsHit) {
  const auto hit = intersect(cone(), {{0, 0, 0}, {1, 0, 0}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->t, 4.5, kExact);
}

TEST(SphereEdge, ASphereThatHoldsTheOtherIsAllThereIs) {
  const SphereEdge swallowed{{{0, 0, 0}, 2}, {{0.5, 0, 0}, 1}};
  EXPECT_NEAR(signed_distance(swallowed, {5, 0, 0}), 3, kExact);
  const auto hit = intersect(swallowed, {{5, 0.3, 0}, {-1, 0, 0}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(5 - hit->t, std::sqrt(4 - 0.09), kExact);
  EXPECT_FALSE(intersect(swallowed, {{5, 2.01, 0}, {-1, 0, 0}}));
}

TEST(SphereEdge, TwoEqualSpheresAtOnePlaceAreASphere) {
  const SphereEdge point{{{1, 2, 3}, 0.5}, {{1, 2, 3}, 0.5}};
  EXPECT_NEAR(signed_distance(point, {1, 2, 5}), 1.5, kExact);
  const auto hit = intersect(point, {{1, 2, 0}, {0, 0, 1}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->t, 2.5, kExact);
}

TEST(SphereEdge, DistanceIsTheLeastOverAllInterpolatedSpheres) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-3, 3);
  for (int i = 0; i < 200; ++i) {
    const SphereEdge edge{{{any(random), any(random), any(random)}, std::abs(any(random))},
                          {{any(random), any(random), any(random)}, std::abs(any(random))}};
    const Vector3d point{any(random), any(random), any(random)};
    EXPECT_NEAR(signed_distance(edge, point), sampled_distance(edge, point), 1e-4) << i;
  }
}

TEST(SphereEdge, EveryHitLiesOnTheSurfaceAndNothingLiesBeforeIt) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> any(-1, 1);
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const SphereEdge edge{{{any(random), any(random), any(random)}, 0.6 * std::abs(any(random))},
                          {{any(random), any(random), any(random)}, 0.6 * std::abs(any(random))}};
    const Vector3d origin{3 * any(random), 3 * any(random), -4};
    const Vector3d target{any(random), any(random), any(random)};
    const Ray ray{origin, (1 + any(random) / 2) * (target - origin)};
    const auto hit = intersect(edge, ray);
    const double end = hit ? hit->t : 4;
    for (int k = 0; k < 40; ++k) {
      EXPECT_GT(signed_distance(edge, ray.origin + end * k / 40 * ray.direction), -1e-9);
    }
    if (!hit) continue;
    ++hits;
    const Vector3d point = ray.origin + hit->t * ray.direction;
    EXPECT_NEAR(signed_distance(edge, point), 0, 1e-8);
    const Vector3d normal = surface_normal(edge, ray, *hit);
    EXPECT_LT(normal.dot(ray.direction), 1e-6);
    EXPECT_NEAR(signed_distance(edge, point + 0.1 * normal), 0.1, 1e-7);
  }
  EXPECT_GT(hits, 300);
}

TEST(SphereEdge, ScaleAndTranslationDoNotChangeTheHit) {
  const SphereEdge edge{{{0.1, 0.2, 3}, 0.3}, {{0.4, -0.3, 3.4}, 0.1}};
  const Ray ray{{0, 0, 0}, {0.05, 0.03, 1}};
  const auto hit = intersect(edge, ray);
  ASSERT_TRUE(hit);
  for (const double scale : {1e-3, 1e6}) {
    const Vector3d offset = scale * Vector3d(3, -7, 2);
    const SphereEdge scaled{{scale * edge.a.centre + offset, scale * edge.a.radius},
                            {scale * edge.b.centre + offset, scale * edge.b.radius}};
    const auto again = intersect(scaled, {offset, scale * ray.direction});
    ASSERT_TRUE(again);
    EXPECT_NEAR(again->t, hit->t, 1e-9);
  }
}

}  // namespace
}  // namespace armature::sdk
