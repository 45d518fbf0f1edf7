#include <cmath>
#include <filesystem>
#include <random>

#include <Eigen/Geometry>
#include <armature/sdk/distance/mesh_tree.h>
#include <armature/sdk/io/read_mesh.h>
#include <gtest/gtest.h>

#include "tests/sdk/mesh/surfaces.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;
using surfaces::mesh_of;

Mesh tetrahedron() {
  return mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}});
}

/// A ball of `n` by `2 n` patches, closed, with pointed triangles at its poles.
Mesh globe(int n, double radius = 1, const Vector3d& centre = Vector3d::Zero()) {
  std::vector<Vector3d> positions{centre + radius * Vector3d::UnitZ()};
  std::vector<std::array<int, 3>> faces;
  for (int i = 1; i < n; ++i)
    for (int j = 0; j < 2 * n; ++j) {
      const double polar = M_PI * i / n;
      const double around = M_PI * j / n;
      positions.push_back(centre + radius * Vector3d(std::sin(polar) * std::cos(around),
                                                     std::sin(polar) * std::sin(around), std::cos(polar)));
    }
  positions.push_back(centre - radius * Vector3d::UnitZ());
  const auto at = [&](int i, int j) { return 1 + (i - 1) * 2 * n + j % (2 * n); };
  for (int j = 0; j < 2 * n; ++j) {
    faces.push_back({0, at(1, j), at(1, j + 1)});
    for (int i = 1; i + 1 < n; ++i) {
      faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
    faces.push_back({at(n - 1, j), static_cast<int>(positions.size()) - 1, at(n - 1, j + 1)});
  }
  return mesh_of(std::move(positions), faces);
}

/// The distance to each triangle by its plane and its sides.
double distance_by_all_faces(const Mesh& mesh, const Vector3d& p) {
  double least = 1e300;
  for (const Triangle& t : mesh.triangles) {
    std::array<Vector3d, 3> c;
    for (std::size_t k = 0; k < 3; ++k) c[k] = mesh.position(t[k]);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3d side = c[(k + 1) % 3] - c[k];
      const double length2 = side.squaredNorm();
      const double along = length2 > 0 ? std::clamp(side.dot(p - c[k]) / length2, 0.0, 1.0) : 0;
      least = std::min(least, (p - c[k] - along * side).norm());
    }
    const Vector3d normal = (c[1] - c[0]).cross(c[2] - c[0]);
    if (normal.norm() == 0) continue;
    bool within = true;
    for (std::size_t k = 0; k < 3; ++k) within &= normal.dot((c[(k + 1) % 3] - c[k]).cross(p - c[k])) >= 0;
    if (within) least = std::min(least, std::abs(normal.dot(p - c[0])) / normal.norm());
  }
  return least;
}

void expect_exact(const Mesh& mesh, unsigned seed, int queries = 300) {
  const MeshTree tree(mesh);
  Eigen::AlignedBox3d box;
  for (const Vector3d& p : mesh.positions) box.extend(p);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(-0.3, 1.3);
  const double size = box.diagonal().norm();
  const double exact = 1e-12 * (size + box.center().norm());
  FaceId last;
  for (int k = 0; k < queries; ++k) {
    const Vector3d p = box.min() + Vector3d(u(random), u(random), u(random)).cwiseProduct(box.sizes());
    const SurfacePoint found = tree.closest(p);
    ASSERT_TRUE(found.face.valid());
    EXPECT_NEAR(found.distance, distance_by_all_faces(mesh, p), 1e-9 * size);
    EXPECT_NEAR((found.point - p).norm(), found.distance, exact);
    Vector3d blended = Vector3d::Zero();
    for (std::size_t c = 0; c < 3; ++c)
      blended += found.barycentric[static_cast<Eigen::Index>(c)] * mesh.corner(found.face, c);
    EXPECT_NEAR((blended - found.point).norm(), 0, exact);
    EXPECT_GE(found.barycentric.minCoeff(), 0);
    EXPECT_NEAR(tree.closest(p, {.hint = last}).distance, found.distance, exact);
    EXPECT_NEAR(tree.closest(p, {.within = found.distance + 2 * exact}).distance, found.distance, exact);
    EXPECT_FALSE(tree.closest(p, {.within = found.distance - 2 * exact}).face.valid());
    last = found.face;
  }
}

TEST(MeshTree, AboveAFaceTheClosestPointIsItsFoot) {
  const MeshTree tree(tetrahedron());
  const SurfacePoint found = tree.closest({0.25, 0.25, -2});
  EXPECT_EQ(found.face, FaceId(0));
  EXPECT_DOUBLE_EQ(found.distance, 2);
  EXPECT_NEAR((found.point - Vector3d(0.25, 0.25, 0)).norm(), 0, 1e-15);
}

TEST(MeshTree, FindsWhatLookingAtEveryFaceFinds) {
  expect_exact(globe(12), 1);
}

TEST(MeshTree, IsAsExactFarFromTheOriginAndAtAnyScale) {
  expect_exact(globe(10, 1e-3), 2);
  expect_exact(globe(10, 1e6), 3);
  expect_exact(globe(10, 1, {1e4, -3e4, 2e4}), 4);
}

TEST(MeshTree, AnswersFromFarAway) {
  const MeshTree tree(globe(16));
  for (const double far : {1e3, 1e9, 1e20}) EXPECT_NEAR(tree.closest({0, 0, far}).distance / (far - 1), 1, 1e-12);
}

TEST(MeshTree, DegenerateFacesAreTheSegmentsAndPointsThatTheyAre) {
  const Mesh mesh = mesh_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 0, 3}, {1, 1e-13, 0}},
                            {{0, 1, 2}, {3, 3, 3}, {0, 0, 2}, {0, 4, 2}});
  expect_exact(mesh, 5, 100);
  const SurfacePoint found = MeshTree(mesh).closest({1.5, 1, 0});
  EXPECT_NEAR(found.distance, 1, 1e-12);
  EXPECT_TRUE(found.point.allFinite());
}

TEST(MeshTree, ManyFacesAtOnePlaceAreNoTrouble) {
  const std::vector<std::array<int, 3>> faces(500, {0, 1, 2});
  const MeshTree tree(mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, faces));
  EXPECT_DOUBLE_EQ(tree.closest({0.2, 0.2, 3}).distance, 3);
}

TEST(MeshTree, AMeshWithoutFacesHasNoClosestPoint) {
  const MeshTree tree(Mesh{});
  EXPECT_FALSE(tree.closest({1, 2, 3}).face.valid());
  EXPECT_FALSE(tree.intersect({{0, 0, 0}, {1, 0, 0}}));
  EXPECT_FALSE(tree.inside({0, 0, 0}));
}

TEST(MeshTree, ARayMeetsTheFirstFace) {
  const MeshTree tree(tetrahedron());
  const auto hit = tree.intersect({{0.2, 0.3, -5}, {0, 0, 2}});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->face, FaceId(0));
  EXPECT_NEAR(hit->t, 2.5, 1e-12);
  const auto from_inside = tree.intersect({{0.1, 0.1, 0.1}, {0, 0, -1}});
  ASSERT_TRUE(from_inside);
  EXPECT_NEAR(from_inside->t, 0.1, 1e-12);
  EXPECT_FALSE(tree.intersect({{2, 2, -5}, {0, 0, 1}}));
}

TEST(MeshTree, TheInsideOfAClosedMeshIsKnown) {
  const Mesh mesh = globe(10);
  Mesh inside_out = mesh;
  for (Triangle& t : inside_out.triangles) std::swap(t[1], t[2]);
  const MeshTree tree(mesh);
  const MeshTree other(inside_out);
  std::mt19937 random(6);
  std::uniform_real_distribution<double> u(-1.5, 1.5);
  for (int k = 0; k < 500; ++k) {
    const Vector3d p{u(random), u(random), u(random)};
    if (p.norm() > 0.94 && p.norm() < 1.01) continue;
    EXPECT_EQ(tree.inside(p), p.norm() < 1);
    EXPECT_EQ(other.inside(p), p.norm() < 1);
    EXPECT_EQ(tree.signed_distance(p) < 0, p.norm() < 1);
  }
}

TEST(MeshTree, IsExactOnARealModel) {
  const std::filesystem::path path = "../shared/data/meshes/cg_raptor.off";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no models at " << path;
  const auto mesh = read_mesh(path);
  ASSERT_TRUE(mesh) << mesh.error().message;
  expect_exact(*mesh, 7, 25);
}

}  // namespace
}  // namespace armature::sdk
