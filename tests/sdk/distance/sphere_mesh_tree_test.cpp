#include <cmath>
#include <random>

#include <Eigen/Geometry>
#include <armature/sdk/distance/sphere_mesh_tree.h>
#include <gtest/gtest.h>

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

/// A random shape of a given number of spheres, with triangles, wire edges and spheres of their own.
SphereMesh tangle(std::size_t spheres, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  SphereMesh shape;
  for (std::size_t k = 0; k < spheres; ++k)
    shape.spheres.push_back({{u(random), u(random), u(random)}, 0.05 + 0.1 * std::abs(u(random))});
  for (std::size_t k = 0; k + 4 < spheres; k += 4) {
    shape.triangles.push_back({SphereId(k), SphereId(k + 1), SphereId(k + 2)});
    shape.edges.push_back({SphereId(k + 2), SphereId(k + 4)});
  }
  return shape;
}

double distance_by_all_primitives(const SphereMesh& shape, const Vector3d& p) {
  double least = 1e300;
  for (const Sphere& s : shape.spheres) least = std::min(least, signed_distance(s, p));
  for (const auto& [a, b] : shape.edges)
    least = std::min(least, signed_distance(SphereEdge{shape.sphere(a), shape.sphere(b)}, p));
  for (const auto& [a, b, c] : shape.triangles)
    least = std::min(least, signed_distance(SphereTriangle{shape.sphere(a), shape.sphere(b), shape.sphere(c)}, p));
  return least;
}

TEST(SphereMeshTree, FindsWhatLookingAtEveryPrimitiveFinds) {
  for (const std::size_t count : {1, 2, 7, 40, 300}) {
    const SphereMesh shape = tangle(count, 1);
    const SphereMeshTree tree(shape);
    std::mt19937 random(2);
    std::uniform_real_distribution<double> u(-1.5, 1.5);
    for (int k = 0; k < 300; ++k) {
      const Vector3d p{u(random), u(random), u(random)};
      const double distance = distance_by_all_primitives(shape, p);
      const NearestSphere nearest = tree.nearest(p);
      EXPECT_NEAR(nearest.distance, distance, 1e-12);
      EXPECT_NEAR(tree.signed_distance(p), distance, 1e-12);
      EXPECT_EQ(tree.inside(p), distance < 0);
      EXPECT_EQ(tree.inside(p, 0.03), distance < -0.03);
      EXPECT_NEAR(signed_distance(nearest.sphere, p), distance, 1e-9);
      EXPECT_NEAR(nearest.weights.sum(), 1, 1e-12);
      EXPECT_NEAR(signed_distance(nearest.sphere, p - nearest.distance * nearest.normal), 0, 1e-9);
    }
  }
}

TEST(SphereMeshTree, FarFromTheOriginAndAtAnyScaleTheDistanceIsTheSame) {
  const SphereMesh shape = tangle(60, 3);
  for (const auto& [scale, offset] : {std::pair{1e-3, 0.0}, {1e6, 0.0}, {1.0, 1e4}}) {
    SphereMesh moved = shape;
    for (Sphere& s : moved.spheres) s = {scale * s.centre + Vector3d::Constant(offset), scale * s.radius};
    const SphereMeshTree tree(moved);
    std::mt19937 random(4);
    std::uniform_real_distribution<double> u(-3, 3);
    for (int k = 0; k < 200; ++k) {
      const Vector3d p{u(random), u(random), u(random)};
      EXPECT_NEAR(tree.signed_distance(scale * p + Vector3d::Constant(offset)) / scale,
                  distance_by_all_primitives(shape, p), 1e-10);
    }
  }
}

TEST(SphereMeshTree, NamesTheSpheresThatTheTouchedOneBlends) {
  SphereMesh shape;
  shape.spheres = {{{0, 0, 0}, 0.25}, {{4, 0, 0}, 0.25}, {{0, 4, 0}, 0.25}, {{0, 0, 9}, 1}};
  shape.triangles = {{SphereId(0), SphereId(1), SphereId(2)}};
  const SphereMeshTree tree(shape);
  const NearestSphere above = tree.nearest({1, 1, 2});
  EXPECT_EQ(above.spheres, (TouchedSpheres{SphereId(0), SphereId(1), SphereId(2)}));
  EXPECT_NEAR((above.weights - Vector3d(0.5, 0.25, 0.25)).norm(), 0, 1e-12);
  const NearestSphere alone = tree.nearest({0, 0, 12});
  EXPECT_EQ(alone.spheres[0], SphereId(3));
  EXPECT_FALSE(alone.spheres[1].valid());
  EXPECT_DOUBLE_EQ(alone.distance, 2);
}

TEST(SphereMeshTree, WithoutSpheresEverythingIsInfinitelyFar) {
  const SphereMeshTree tree(SphereMesh{});
  EXPECT_TRUE(std::isinf(tree.signed_distance({0, 0, 0})));
  EXPECT_FALSE(tree.inside({0, 0, 0}));
  EXPECT_FALSE(tree.intersect({{0, 0, 0}, {1, 0, 0}}));
}

TEST(SphereMeshTree, ARayStopsWhereTheUnionBegins) {
  const SphereMesh shape = tangle(60, 5);
  const SphereMeshTree tree(shape);
  std::mt19937 random(6);
  std::uniform_real_distribution<double> u(-1, 1);
  int hits = 0;
  for (int k = 0; k < 400; ++k) {
    const Ray ray{{2 * u(random), 2 * u(random), 2 * u(random)}, {u(random), u(random), u(random)}};
    const double side = distance_by_all_primitives(shape, ray.origin) < 0 ? -1 : 1;
    const auto hit = tree.intersect(ray);
    const double end = hit ? hit->t : 10;
    for (int i = 1; i < 300; ++i)
      EXPECT_GT(side * distance_by_all_primitives(shape, ray.origin + end * i / 300 * ray.direction), -1e-9);
    if (!hit) continue;
    ++hits;
    const Vector3d x = ray.origin + hit->t * ray.direction;
    EXPECT_NEAR(distance_by_all_primitives(shape, x), 0, 1e-9);
    EXPECT_GT(distance_by_all_primitives(shape, x + 1e-6 * hit->normal), -1e-9);
    EXPECT_GE(-side * hit->normal.dot(ray.direction), -1e-9);
  }
  EXPECT_GT(hits, 50);
}

}  // namespace
}  // namespace armature::sdk
