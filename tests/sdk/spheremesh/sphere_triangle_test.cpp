#include <cmath>
#include <random>

#include <Eigen/Geometry>
#include <armature/sdk/spheremesh/sphere_triangle.h>
#include <gtest/gtest.h>

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

constexpr double kExact = 1e-12;  // of unit-sized shapes

SphereTriangle plate() {
  return {{{0, 0, 0}, 0.3}, {{3, 0, 0}, 0.5}, {{0, 2, 0}, 0.2}};
}

/// The shapes that break formulas: named by what is wrong with them.
std::vector<std::pair<const char*, SphereTriangle>> degenerate_triangles() {
  return {{"collinear centres", {{{0, 0, 0}, 0.3}, {{1, 0, 0}, 0.8}, {{3, 0, 0}, 0.2}}},
          {"coincident spheres", {{{1, 1, 1}, 0.5}, {{1, 1, 1}, 0.5}, {{1, 1, 1}, 0.5}}},
          {"two coincident spheres", {{{0, 0, 0}, 0.5}, {{0, 0, 0}, 0.5}, {{2, 0, 0}, 0.1}}},
          {"one holds the others", {{{0, 0, 0}, 3}, {{0.5, 0, 0}, 0.5}, {{0, 0.5, 0}, 0.2}}},
          {"one holds another", {{{0, 0, 0}, 1}, {{0.5, 0, 0}, 0.3}, {{0, 3, 0}, 0.4}}},
          {"steeper than the plane", {{{0, 0, 0}, 1}, {{2, 0.3, 0}, 0.2}, {{2, -0.3, 0}, 1.5}}},
          {"points", {{{0, 0, 0}, 0}, {{2, 0, 0}, 0}, {{0, 2, 0}, 0}}},
          {"nearly collinear", {{{0, 0, 0}, 0.3}, {{1, 1e-7, 0}, 0.3}, {{2, 0, 0}, 0.3}}}};
}

double sampled_distance(const SphereTriangle& t, const Vector3d& p, int steps = 400) {
  double least = 1e9;
  for (int i = 0; i <= steps; ++i)
    for (int j = 0; i + j <= steps; ++j)
      least = std::min(
          least,
          signed_distance(interpolated(t, {1 - (i + j) / double(steps), i / double(steps), j / double(steps)}), p));
  return least;
}

Vector3d random_point(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> u(-size, size);
  return {u(random), u(random), u(random)};
}

TEST(SphereTriangle, AboveItsMiddleTheFacetIsAsFarAsItsPlane) {
  const SphereTriangle t{{{0, 0, 0}, 0.25}, {{4, 0, 0}, 0.25}, {{0, 4, 0}, 0.25}};
  const Touch above = touch(t, {1, 1, 2});
  EXPECT_NEAR(above.distance, 1.75, kExact);
  EXPECT_NEAR((above.weights - Vector3d(0.5, 0.25, 0.25)).norm(), 0, kExact);
  EXPECT_NEAR((above.normal - Vector3d::UnitZ()).norm(), 0, kExact);
  EXPECT_NEAR(signed_distance(t, {1, 1, -0.05}), -0.2, kExact);
}

TEST(SphereTriangle, ItsDistanceIsThatToTheNearestOfAllInterpolatedSpheres) {
  std::mt19937 random(1);
  for (int k = 0; k < 60; ++k) {
    const Vector3d p = random_point(random, 4);
    const double exact = signed_distance(plate(), p);
    const double sampled = sampled_distance(plate(), p);
    EXPECT_LE(exact, sampled + kExact);
    EXPECT_NEAR(exact, sampled, 1e-3);
  }
}

TEST(SphereTriangle, DegenerateTrianglesHaveTheDistanceOfTheirSpheres) {
  std::mt19937 random(2);
  for (const auto& [name, t] : degenerate_triangles())
    for (int k = 0; k < 15; ++k) {
      const Vector3d p = random_point(random, 3);
      const double exact = signed_distance(t, p);
      const double sampled = sampled_distance(t, p, 300);
      EXPECT_LE(exact, sampled + 1e-9) << name;
      EXPECT_NEAR(exact, sampled, 4e-3) << name;
    }
}

TEST(SphereTriangle, TheTouchedSphereIsAsFarAsTheDistanceSays) {
  std::mt19937 random(3);
  auto shapes = degenerate_triangles();
  shapes.emplace_back("plate", plate());
  for (const auto& [name, t] : shapes)
    for (int k = 0; k < 200; ++k) {
      const Vector3d p = random_point(random, 3);
      const Touch nearest = touch(t, p);
      const Sphere touched = interpolated(t, nearest.weights);
      EXPECT_NEAR(signed_distance(touched, p), nearest.distance, 1e-9) << name;
      EXPECT_NEAR(nearest.weights.sum(), 1, kExact) << name;
      EXPECT_GE(nearest.weights.minCoeff(), -kExact) << name;
      EXPECT_NEAR(nearest.normal.norm(), 1, 1e-9) << name;
      EXPECT_NEAR(signed_distance(t, closest_point(p, nearest)), 0, 1e-9) << name;
    }
}

TEST(SphereTriangle, FromACentreTheClosestPointLiesOnTheSurfaceToo) {
  auto shapes = degenerate_triangles();
  shapes.emplace_back("plate", plate());
  for (const auto& [name, t] : shapes)
    for (const Vector3d& p : {t.a.centre, t.b.centre, t.c.centre, Vector3d((t.a.centre + t.b.centre) / 2),
                              Vector3d((t.a.centre + t.b.centre + t.c.centre) / 3)}) {
      const Touch nearest = touch(t, p);
      EXPECT_NEAR(signed_distance(t, closest_point(p, nearest)), 0, 1e-9) << name;
    }
}

TEST(SphereTriangle, ItsTangentPlanesTouchAllThreeSpheres) {
  const SphereTriangle t = plate();
  const auto normals = tangent_normals(t);
  ASSERT_TRUE(normals);
  for (const Vector3d& n : *normals) {
    EXPECT_NEAR(n.norm(), 1, kExact);
    const double reach = n.dot(t.a.centre) + t.a.radius;
    EXPECT_NEAR(n.dot(t.b.centre) + t.b.radius, reach, kExact);
    EXPECT_NEAR(n.dot(t.c.centre) + t.c.radius, reach, kExact);
  }
  EXPECT_GT((*normals)[0].z(), 0);
  EXPECT_FALSE(tangent_normals({{{0, 0, 0}, 1}, {{2, 0.3, 0}, 0.2}, {{2, -0.3, 0}, 1.5}}));
}

/// Every passage against marching along the line by the distance.
void expect_passages_are_where_the_distance_vanishes(const SphereTriangle& t, const char* name, unsigned seed) {
  std::mt19937 random(seed);
  for (int k = 0; k < 200; ++k) {
    const Ray ray{random_point(random, 5), random_point(random, 1)};
    const auto through = passage(t, ray);
    double least = 1e9;
    for (int i = -800; i <= 800; ++i)
      least = std::min(least, signed_distance(t, ray.origin + 0.02 * i * ray.direction));
    if (!through) {
      EXPECT_GT(least, -1e-6) << name;
      continue;
    }
    EXPECT_LE(through->entry.t, through->exit.t);
    for (const Crossing& crossing : {through->entry, through->exit}) {
      const Vector3d x = ray.origin + crossing.t * ray.direction;
      EXPECT_NEAR(signed_distance(t, x), 0, 1e-7) << name;
      EXPECT_NEAR(signed_distance(interpolated(t, crossing.weights), x), 0, 1e-6) << name;
    }
    const auto hit = intersect(t, ray);
    EXPECT_EQ(hit.has_value(), through->exit.t > 0);
  }
}

TEST(SphereTriangle, LinesPassWhereTheDistanceVanishes) {
  expect_passages_are_where_the_distance_vanishes(plate(), "plate", 4);
  expect_passages_are_where_the_distance_vanishes({{{0, 0, 0}, 1.2}, {{2, 0, 1}, 0.3}, {{-1, 2, 0}, 0.1}}, "wedge", 5);
}

TEST(SphereTriangle, LinesPassDegenerateTrianglesTheSameWay) {
  unsigned seed = 6;
  for (const auto& [name, t] : degenerate_triangles()) expect_passages_are_where_the_distance_vanishes(t, name, ++seed);
}

}  // namespace
}  // namespace armature::sdk
