#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include <Eigen/Geometry>
#include <armature/sdk/distance/measure.h>
#include <armature/sdk/spheremesh/extract.h>
#include <armature/sdk/spheremesh/make_sphere_mesh.h>
#include <gtest/gtest.h>

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

SphereMesh capsule() {
  return make_sphere_mesh({{{0, 0, 0}, 1}, {{3, 0, 0}, 0.5}}, std::vector<SpherePair>{{SphereId(0), SphereId(1)}}, {});
}

/// Spheres in a ring, joined by edges.
SphereMesh torus(std::size_t count) {
  std::vector<Sphere> spheres;
  std::vector<SpherePair> edges;
  for (std::size_t k = 0; k < count; ++k) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(count);
    spheres.push_back({{std::cos(angle), std::sin(angle), 0}, 0.25});
    edges.push_back({SphereId(k), SphereId((k + 1) % count)});
  }
  return make_sphere_mesh(std::move(spheres), edges, {});
}

SphereMesh box_around_a_void() {
  std::vector<Sphere> spheres;
  for (int k = 0; k < 8; ++k) spheres.push_back({{k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? 1.0 : -1.0}, 0.2});
  std::vector<SphereTriple> triangles;
  for (const auto& [a, b, c, d] : std::vector<std::array<int, 4>>{
           {0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 4, 5}, {2, 3, 6, 7}, {0, 2, 4, 6}, {1, 3, 5, 7}}) {
    triangles.push_back({SphereId(a), SphereId(b), SphereId(c)});
    triangles.push_back({SphereId(b), SphereId(c), SphereId(d)});
  }
  return make_sphere_mesh(std::move(spheres), {}, triangles);
}

struct Topology {
  bool closed_and_oriented = true;  ///< every directed side once, and once the other way
  bool manifold_vertices = true;    ///< the faces at a vertex are one fan
  long components = 0;
  long genus = 0;  ///< summed over components
  double volume = 0;
};

Topology topology(const Mesh& mesh) {
  Topology result;
  using Side = std::pair<std::size_t, std::size_t>;
  std::set<Side> sides;
  std::vector<std::map<std::size_t, std::size_t>> fans(mesh.positions.size());
  std::vector<std::size_t> parent(mesh.positions.size());
  for (std::size_t k = 0; k < parent.size(); ++k) parent[k] = k;
  const auto root = [&](std::size_t v) {
    while (parent[v] != v) v = parent[v];
    return v;
  };
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t a = t[k].index(), b = t[(k + 1) % 3].index();
      if (!sides.insert({a, b}).second) result.closed_and_oriented = false;
      fans[a][b] = t[(k + 2) % 3].index();
      parent[root(a)] = root(b);
    }
  for (const auto& [a, b] : sides)
    if (!sides.contains({b, a})) result.closed_and_oriented = false;
  std::set<std::size_t> roots;
  for (std::size_t v = 0; v < fans.size(); ++v) {
    roots.insert(root(v));
    if (fans[v].empty()) {
      result.manifold_vertices = false;
      continue;
    }
    std::size_t steps = 0;
    std::size_t at = fans[v].begin()->first;
    do {
      const auto next = fans[v].find(at);
      if (next == fans[v].end()) break;
      at = next->second;
    } while (++steps < fans[v].size() && at != fans[v].begin()->first);
    if (steps != fans[v].size()) result.manifold_vertices = false;
  }
  result.components = static_cast<long>(roots.size());
  const long euler = static_cast<long>(mesh.positions.size()) - static_cast<long>(sides.size() / 2) +
                     static_cast<long>(mesh.triangles.size());
  result.genus = result.components - euler / 2;
  for (const Triangle& t : mesh.triangles)
    result.volume += mesh.position(t[0]).dot(mesh.position(t[1]).cross(mesh.position(t[2]))) / 6;
  return result;
}

/// Whether a segment runs through a triangle.
bool runs_through(const Vector3d& p, const Vector3d& q, const std::array<Vector3d, 3>& t) {
  const auto side = [](const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& x) {
    return (b - a).cross(c - a).dot(x - a);
  };
  if (side(t[0], t[1], t[2], p) * side(t[0], t[1], t[2], q) >= 0) return false;
  const double a = side(p, q, t[0], t[1]), b = side(p, q, t[1], t[2]), c = side(p, q, t[2], t[0]);
  return (a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0);
}

/// Pairs of a face and an edge of another one that runs through it.
int pairs_that_cross(const Mesh& mesh) {
  const auto corners = [&](std::size_t f) {
    return std::array{mesh.corner(FaceId(f), 0), mesh.corner(FaceId(f), 1), mesh.corner(FaceId(f), 2)};
  };
  int count = 0;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const auto t = corners(f);
    const Vector3d lower = t[0].cwiseMin(t[1]).cwiseMin(t[2]), upper = t[0].cwiseMax(t[1]).cwiseMax(t[2]);
    for (std::size_t g = 0; g < mesh.triangles.size(); ++g) {
      const auto u = corners(g);
      for (std::size_t k = 0; k < 3; ++k) {
        const Vector3d &p = u[k], &q = u[(k + 1) % 3];
        if ((p.cwiseMin(q).array() <= upper.array()).all() && (p.cwiseMax(q).array() >= lower.array()).all())
          count += runs_through(p, q, t) ? 1 : 0;
      }
    }
  }
  return count;
}

void expect_surface(const SphereMesh& shape, double tolerance, long components, long genus) {
  const auto mesh = extract_surface(shape, {.tolerance = tolerance});
  ASSERT_TRUE(mesh) << mesh.error().message;
  const Topology found = topology(*mesh);
  EXPECT_TRUE(found.closed_and_oriented);
  EXPECT_TRUE(found.manifold_vertices);
  EXPECT_EQ(found.components, components);
  EXPECT_EQ(found.genus, genus);
  EXPECT_GT(found.volume, 0);
  const auto errors = measure(*mesh, shape, {.samples = 20000});
  ASSERT_TRUE(errors);
  EXPECT_LE(errors->hausdorff, 100 * tolerance);
  EXPECT_EQ(pairs_that_cross(*mesh), 0);
}

TEST(Extract, ACapsuleIsABallInFewTriangles) {
  expect_surface(capsule(), 3e-3, 1, 0);
  EXPECT_LT(extract_surface(capsule(), {.tolerance = 3e-3})->triangles.size(), 400U);
}

TEST(Extract, ItsVolumeComesCloserAsTheToleranceFalls) {
  const double growth = 0.5 / 3;
  // Two caps and a cone between the contact circles.
  const double slope = std::sqrt(1 - growth * growth);
  const auto cap = [](double r, double h) { return std::numbers::pi * h * h * (3 * r - h) / 3; };
  const double ra = slope, rb = 0.5 * slope, height = 3 - growth * (1 - 0.5);
  const double exact =
      cap(1, 1 + growth) + cap(0.5, 0.5 * (1 - growth)) + std::numbers::pi * height * (ra * ra + ra * rb + rb * rb) / 3;
  const double coarse = topology(*extract_surface(capsule(), {.tolerance = 1e-2})).volume;
  const double fine = topology(*extract_surface(capsule(), {.tolerance = 1e-3})).volume;
  EXPECT_LT(std::abs(fine - exact), std::abs(coarse - exact));
  EXPECT_NEAR(fine / exact, 1, 0.01);
}

TEST(Extract, ARingOfSpheresHasOneHole) {
  expect_surface(torus(12), 4e-3, 1, 1);
}

TEST(Extract, BallsApartAreComponents) {
  SphereMesh shape;
  shape.spheres = {{{0, 0, 0}, 1}, {{3, 0, 0}, 1}};
  expect_surface(shape, 5e-3, 2, 0);
}

TEST(Extract, AClosedVoidIsLeftOut) {
  expect_surface(box_around_a_void(), 5e-3, 1, 0);
}

TEST(Extract, VerticesLieOnCreases) {
  SphereMesh shape;
  shape.spheres = {{{-0.5, 0, 0}, 1}, {{0.5, 0, 0}, 1}};
  const auto mesh = extract_surface(shape, {.tolerance = 4e-3});
  ASSERT_TRUE(mesh);
  // The crease is the circle of radius sqrt(3/4) in x = 0.
  const double tolerance = 4e-3 * (Vector3d(3, 2, 2).norm());
  int on_crease = 0;
  for (const Vector3d& p : mesh->positions)
    on_crease += std::abs(p.x()) < tolerance && std::abs(std::hypot(p.y(), p.z()) - std::sqrt(0.75)) < tolerance;
  EXPECT_GE(on_crease, 12);
}

TEST(Extract, ACleftThatIsNarrowAtItsBottomIsOpen) {
  // Its walls meet at 52 degrees.
  SphereMesh shape;
  shape.spheres = {{{-0.9, 0, 0}, 1}, {{0.9, 0, 0}, 1}};
  expect_surface(shape, 1e-2, 1, 0);
}

TEST(Extract, AVoidWithASlitInItsWallIsClosed) {
  SphereMesh box = box_around_a_void();
  // One wall a little short of the edge that it met.
  const double away = 1e-3;
  for (const int k : {4, 5}) box.spheres.push_back({{k & 1 ? 1.0 : -1.0, -1.0 + 0.4 + away, 1.0}, 0.2});
  std::vector<SphereTriple> walls;
  for (SphereTriple triangle : box.triangles) {
    const bool top = std::all_of(triangle.begin(), triangle.end(), [](SphereId id) { return id.index() >= 4; });
    if (top)
      for (SphereId& id : triangle)
        if (id.index() < 6) id = SphereId(id.index() + 4);
    walls.push_back(triangle);
  }
  const auto mesh = extract_surface(make_sphere_mesh(box.spheres, {}, walls), {.tolerance = 5e-3});
  ASSERT_TRUE(mesh);
  const Topology found = topology(*mesh);
  EXPECT_TRUE(found.closed_and_oriented);
  EXPECT_GT(found.volume, 0.9 * 2.4 * 2.4 * 2.4);
}

TEST(Extract, APlateWithoutThicknessIsThickenedToTheTolerance) {
  const SphereMesh plate = make_sphere_mesh(
      {{{0, 0, 0}, 0}, {{1, 0, 0}, 0}, {{1, 1, 0}, 0}, {{0, 1, 0}, 0}}, {},
      std::vector<SphereTriple>{{SphereId(0), SphereId(1), SphereId(2)}, {SphereId(0), SphereId(2), SphereId(3)}});
  expect_surface(plate, 5e-3, 1, 0);
}

TEST(Extract, TheSameShapeGivesTheSameMesh) {
  const auto once = extract_surface(torus(8), {.tolerance = 1e-2});
  const auto again = extract_surface(torus(8), {.tolerance = 1e-2});
  ASSERT_TRUE(once && again);
  EXPECT_EQ(once->positions, again->positions);
  EXPECT_EQ(once->triangles, again->triangles);
}

TEST(Extract, WhatHasNoSurfaceIsRefused) {
  EXPECT_FALSE(extract_surface(SphereMesh{}));
  SphereMesh point;
  point.spheres = {{{1, 2, 3}, 0}};
  EXPECT_FALSE(extract_surface(point));
  EXPECT_FALSE(extract_surface(capsule(), {.tolerance = 0}));
  EXPECT_FALSE(extract_surface(capsule(), {.tolerance = std::nan("")}));
}

TEST(Extract, StopsWhenAsked) {
  std::stop_source source;
  source.request_stop();
  const auto mesh = extract_surface(torus(12), {.tolerance = 2e-3}, {.stop = source.get_token()});
  ASSERT_FALSE(mesh);
  EXPECT_EQ(mesh.error().kind, ErrorKind::Cancelled);
}

}  // namespace
}  // namespace armature::sdk
