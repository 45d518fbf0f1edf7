#include <algorithm>
#include <set>

#include <armature/sdk/mesh/adjacency.h>
#include <gtest/gtest.h>

#include "tests/sdk/mesh/surfaces.h"

namespace armature::sdk {
namespace {

TEST(Adjacency, OfACubeKnowsEighteenEdgesOfTwoFacesEach) {
  const Adjacency cube(surfaces::cube());
  EXPECT_EQ(cube.edge_count(), 18U);
  for (std::size_t i = 0; i < cube.edge_count(); ++i) EXPECT_EQ(cube.faces(EdgeId(i)).size(), 2U);
  EXPECT_TRUE(std::ranges::is_sorted(cube.edges()));
}

TEST(Adjacency, AgreesWithTheTrianglesItCameFrom) {
  const Mesh mesh = surfaces::torus(2, 1, 9, 7);
  const Adjacency adjacency(mesh);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    std::set<VertexId> neighbours;
    std::vector<FaceId> faces;
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
      if (std::ranges::find(mesh.triangles[f], VertexId(v)) == mesh.triangles[f].end()) continue;
      faces.emplace_back(f);
      neighbours.insert(mesh.triangles[f].begin(), mesh.triangles[f].end());
    }
    neighbours.erase(VertexId(v));
    EXPECT_TRUE(std::ranges::equal(adjacency.faces(VertexId(v)), faces));
    EXPECT_TRUE(std::ranges::equal(adjacency.neighbours(VertexId(v)), neighbours));
    const auto edges = adjacency.edges(VertexId(v));
    ASSERT_EQ(edges.size(), neighbours.size());
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const VertexPair expected = vertex_pair(VertexId(v), adjacency.neighbours(VertexId(v))[i]);
      EXPECT_EQ(adjacency.edge(edges[i]), expected);
    }
  }
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      const EdgeId edge = adjacency.edges(FaceId(f))[k];
      const VertexPair expected = vertex_pair(mesh.triangles[f][k], mesh.triangles[f][(k + 1) % 3]);
      EXPECT_EQ(adjacency.edge(edge), expected);
      EXPECT_EQ(std::ranges::count(adjacency.faces(edge), FaceId(f)), 1);
    }
  }
}

TEST(Adjacency, LetsAnyNumberOfFacesShareAnEdge) {
  Mesh fan;
  fan.positions.resize(6, Eigen::Vector3d::Zero());
  for (std::size_t i = 2; i < 6; ++i) fan.triangles.push_back(surfaces::triangle(1, 0, i));
  const Adjacency adjacency(fan);
  EXPECT_EQ(adjacency.edge_count(), 9U);
  EXPECT_EQ(adjacency.faces(EdgeId(0)).size(), 4U);
}

TEST(Adjacency, LeavesOutAFaceThatNamesAVertexTwice) {
  Mesh mesh;
  mesh.positions.resize(4, Eigen::Vector3d::Zero());
  mesh.triangles = {surfaces::triangle(0, 1, 1), surfaces::triangle(0, 1, 2)};
  const Adjacency adjacency(mesh);
  EXPECT_EQ(adjacency.edge_count(), 3U);
  EXPECT_EQ(adjacency.faces(VertexId(1)).size(), 1U);
  EXPECT_FALSE(adjacency.edges(FaceId(0))[0].valid());
  EXPECT_TRUE(adjacency.neighbours(VertexId(3)).empty());
}

TEST(Adjacency, OfNothingIsNothing) {
  const Adjacency adjacency{Mesh{}};
  EXPECT_EQ(adjacency.vertex_count(), 0U);
  EXPECT_EQ(adjacency.edge_count(), 0U);
}

}  // namespace
}  // namespace armature::sdk
