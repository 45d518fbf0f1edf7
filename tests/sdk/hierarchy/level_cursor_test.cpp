#include <algorithm>
#include <filesystem>
#include <vector>

#include <armature/sdk/distance/measure.h>
#include <armature/sdk/hierarchy/build.h>
#include <armature/sdk/hierarchy/level_cursor.h>
#include <armature/sdk/io/read_mesh.h>
#include <gtest/gtest.h>

#include "tests/sdk/hierarchy/shapes.h"

namespace armature::sdk {
namespace {

/// Simplices by node, sorted: comparable whatever the order of the spheres.
struct Complex {
  std::vector<NodeId> nodes;
  std::vector<std::array<NodeId, 2>> edges;
  std::vector<std::array<NodeId, 3>> triangles;
  bool operator==(const Complex&) const = default;
};

Complex complex_of(const SphereMesh& mesh, std::span<const NodeId> nodes) {
  Complex complex{{nodes.begin(), nodes.end()}, {}, {}};
  std::sort(complex.nodes.begin(), complex.nodes.end());
  for (const auto& e : mesh.edges) complex.edges.push_back({nodes[e[0].index()], nodes[e[1].index()]});
  for (const auto& t : mesh.triangles)
    complex.triangles.push_back({nodes[t[0].index()], nodes[t[1].index()], nodes[t[2].index()]});
  for (auto& e : complex.edges) std::sort(e.begin(), e.end());
  for (auto& t : complex.triangles) std::sort(t.begin(), t.end());
  std::sort(complex.edges.begin(), complex.edges.end());
  std::sort(complex.triangles.begin(), complex.triangles.end());
  return complex;
}

void expect_level(const Hierarchy& hierarchy, const LevelCursor& cursor) {
  const auto nodes = hierarchy.nodes_of_level(cursor.size());
  const auto expected = hierarchy.level(cursor.size());
  ASSERT_TRUE(expected);
  EXPECT_TRUE(complex_of(*expected, nodes) == complex_of(cursor.sphere_mesh(), cursor.nodes())) << cursor.size();
}

TEST(LevelCursor, WalksEveryLevelDownAndUp) {
  for (const auto& mesh : {ball(2), two_balls(1), soup(40)}) {
    const auto build = build_hierarchy(mesh);
    ASSERT_TRUE(build);
    LevelCursor cursor(build->hierarchy, mesh.positions.size());
    expect_level(build->hierarchy, cursor);
    while (cursor.coarsen()) expect_level(build->hierarchy, cursor);
    EXPECT_EQ(cursor.size(), 1U);
    while (cursor.refine()) expect_level(build->hierarchy, cursor);
    EXPECT_EQ(cursor.size(), mesh.positions.size());
  }
}

TEST(LevelCursor, StartsAnywhereAndWalksToTheFinest) {
  const auto build = build_hierarchy(soup(60));
  ASSERT_TRUE(build);
  for (const std::size_t start : {1, 2, 7, 20, 45}) {
    LevelCursor cursor(build->hierarchy, start);
    expect_level(build->hierarchy, cursor);
    while (cursor.refine()) expect_level(build->hierarchy, cursor);
  }
}

TEST(LevelCursor, WalksLevelsOfPoints) {
  const auto build = build_hierarchy(sample_points(ball(3), 150));
  ASSERT_TRUE(build);
  LevelCursor cursor(build->hierarchy, build->hierarchy.leaf_count());
  while (cursor.coarsen()) expect_level(build->hierarchy, cursor);
  while (cursor.refine()) expect_level(build->hierarchy, cursor);
}

TEST(LevelCursor, GoesFarAndNear) {
  const std::filesystem::path path = "../shared/data/meshes/camel_mc_2020.off";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const auto mesh = read_mesh(path);
  ASSERT_TRUE(mesh);
  const auto build = build_hierarchy(*mesh);
  ASSERT_TRUE(build);
  LevelCursor cursor(build->hierarchy, 2020);
  for (const std::size_t spheres : {1000, 50, 45, 60, 2000, 1, 3}) {
    cursor.go_to(spheres);
    EXPECT_EQ(cursor.size(), spheres);
    expect_level(build->hierarchy, cursor);
  }
}

}  // namespace
}  // namespace armature::sdk
