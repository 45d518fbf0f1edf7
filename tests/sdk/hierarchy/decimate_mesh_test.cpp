#include <armature/sdk/hierarchy/decimate_mesh.h>
#include <armature/sdk/mesh/measures.h>
#include <gtest/gtest.h>

#include "tests/sdk/hierarchy/shapes.h"
#include "tests/sdk/mesh/surfaces.h"

namespace armature::sdk {
namespace {

/// A square of cells x cells, each two triangles, in the plane z = 0.
Mesh sheet(std::size_t cells) {
  Mesh mesh;
  for (std::size_t y = 0; y <= cells; ++y)
    for (std::size_t x = 0; x <= cells; ++x)
      mesh.positions.emplace_back(static_cast<double>(x), static_cast<double>(y), 0);
  const auto at = [&](std::size_t x, std::size_t y) { return VertexId(y * (cells + 1) + x); };
  for (std::size_t y = 0; y < cells; ++y)
    for (std::size_t x = 0; x < cells; ++x) {
      mesh.triangles.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      mesh.triangles.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  return mesh;
}

TEST(DecimateMesh, KeepsThePlaneAndItsBoundary) {
  const auto result = decimate_mesh(sheet(16), {.vertices = 20});
  ASSERT_TRUE(result);
  EXPECT_EQ(result->mesh.positions.size(), 20U);
  double area = 0;
  for (const auto& [a, b, c] : result->mesh.triangles) {
    const Eigen::Vector3d u = result->mesh.position(b) - result->mesh.position(a);
    const Eigen::Vector3d v = result->mesh.position(c) - result->mesh.position(a);
    area += 0.5 * (u.x() * v.y() - u.y() * v.x());
  }
  EXPECT_NEAR(area, 256, 1e-6);
  for (const auto& p : result->mesh.positions) EXPECT_NEAR(p.z(), 0, 1e-9);
}

TEST(DecimateMesh, TurnsNoTriangleOverWhereThatIsPenalised) {
  const auto faces_down = [](bool penalise_flips) {
    const auto result =
        decimate_mesh(surfaces::paraboloid(0, 3, 30, 0.3), {.vertices = 100, .penalise_flips = penalise_flips});
    EXPECT_TRUE(result.has_value());
    std::size_t count = 0;
    for (std::size_t f = 0; f < result->mesh.triangles.size(); ++f)
      count += area_vector(result->mesh, FaceId(f)).z() < 0 ? 1U : 0U;
    return count;
  };
  EXPECT_EQ(faces_down(true), 0U);
  EXPECT_GT(faces_down(false), 0U);
}

TEST(DecimateMesh, StaysNearASphere) {
  const auto result = decimate_mesh(ball(4), {.vertices = 100, .keep_topology = true});
  ASSERT_TRUE(result);
  EXPECT_EQ(result->mesh.positions.size(), 100U);
  EXPECT_EQ(result->mesh.triangles.size(), 196U);
  for (const auto& p : result->mesh.positions) EXPECT_NEAR(p.norm(), 1, 0.05);
}

TEST(DecimateMesh, TellsWhereEveryVertexCameTo) {
  const auto mesh = two_balls(2);
  const auto result = decimate_mesh(mesh, {.vertices = 40});
  ASSERT_TRUE(result);
  ASSERT_EQ(result->came_to.size(), mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    EXPECT_LT((result->mesh.position(result->came_to[v]) - mesh.positions[v]).norm(), 1.2);
}

TEST(DecimateMesh, IsTheInputWhereNothingIsToBeDone) {
  const auto mesh = ball(2);
  const auto result = decimate_mesh(mesh, {.vertices = 1000});
  ASSERT_TRUE(result);
  EXPECT_EQ(result->mesh.positions, mesh.positions);
  EXPECT_EQ(result->mesh.triangles, mesh.triangles);
}

TEST(DecimateMesh, SurvivesASoup) {
  for (const std::size_t vertices : {1U, 5U, 20U}) {
    const auto result = decimate_mesh(soup(40), {.vertices = vertices});
    ASSERT_TRUE(result);
    for (const auto& p : result->mesh.positions) EXPECT_TRUE(p.allFinite());
  }
  EXPECT_FALSE(decimate_mesh({}, {.vertices = 1}));
  EXPECT_FALSE(decimate_mesh(ball(1), {.vertices = 0}));
}

}  // namespace
}  // namespace armature::sdk
