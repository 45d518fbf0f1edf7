#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include <armature/sdk/mesh/components.h>
#include <armature/sdk/mesh/measures.h>
#include <armature/sdk/selection/patch_brush.h>
#include <gtest/gtest.h>

#include "tests/sdk/mesh/surfaces.h"
#include "tests/sdk/selection/table.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

using table::faces_within;
using table::middle;
using table::overlap;
using table::table_with_a_block;

bool hangs_together(const Mesh& mesh, const std::vector<FaceId>& faces) {
  Mesh part{.positions = mesh.positions};
  for (const FaceId face : faces) part.triangles.push_back(mesh.triangle(face));
  return find_components(part, Adjacency(part), LinkedBy::Edges).count == 1;
}

std::string refusal(const Expected<std::vector<FaceId>>& patch) {
  return patch ? "accepted" : patch.error().message;
}

TEST(PatchBrush, StopsWhereTheSurfaceBends) {
  const Mesh mesh = table_with_a_block();
  const Surface surface(mesh);
  const auto patch = select_patch(surface, {.strokes = {{{-0.1, 0, 0.2}, {0.1, 0.05, 0.2}}}, .radius = 0.2});
  ASSERT_TRUE(patch) << refusal(patch);
  EXPECT_GT(overlap(mesh, *patch, faces_within(mesh, 0.45)), 0.9);
  EXPECT_TRUE(hangs_together(mesh, *patch));
}

TEST(PatchBrush, TheBackgroundIsLeftOutAndTheLastBrushCounts) {
  const Mesh mesh = table_with_a_block();
  const Surface surface(mesh);
  const PatchStrokes drawn{
      .strokes = {{{-0.2, 0, 0.2}}}, .radius = 0.15, .background = {{{0.2, -0.3, 0.2}, {0.2, 0.3, 0.2}}}};
  const auto patch = select_patch(surface, drawn);
  ASSERT_TRUE(patch) << refusal(patch);
  for (const FaceId face : *patch) EXPECT_LT(middle(mesh, face).x(), 0.15);
  PatchBrush brush(surface, 0.1);
  const SurfacePoint point = surface.tree.closest({0, 0, 0.2});
  brush.draw_to(point, Brush::Background);
  EXPECT_TRUE(brush.faces().empty());
  brush.draw_to(point, Brush::Patch);
  EXPECT_FALSE(brush.faces().empty());
}

TEST(PatchBrush, DrawingPointByPointIsTheSameAsWholeStrokes) {
  const Mesh mesh = table_with_a_block();
  const Surface surface(mesh);
  const std::vector<Vector3d> stroke = {{-0.2, 0, 0.2}, {0, 0.1, 0.2}, {0.2, 0, 0.2}};
  PatchBrush brush(surface, 0.1);
  std::size_t before = 0;
  for (const Vector3d& point : stroke) {
    brush.draw_to(surface.tree.closest(point));
    EXPECT_GT(brush.faces().size(), 0);
    EXPECT_TRUE(hangs_together(mesh, brush.faces()));
    before = brush.faces().size();
  }
  EXPECT_EQ(before, select_patch(surface, {.strokes = {stroke}, .radius = 0.1})->size());
}

TEST(PatchBrush, DoesNotReachThroughAThinSheet) {
  const Mesh top = surfaces::over({40, 40, false, false, 0}, [](double i, double j) { return Vector3d(i, j, 0); });
  Mesh mesh = surfaces::together(top, surfaces::moved(surfaces::inside_out(top), {0, 0, -0.01}));
  const Surface surface(mesh);
  const auto patch = select_patch(surface, {.strokes = {{{0.5, 0.5, 0}}}, .radius = 0.1});
  ASSERT_TRUE(patch);
  for (const FaceId face : *patch) EXPECT_LT(face.index(), top.triangles.size());
}

TEST(PatchBrush, AcrossTwoComponentsTheLargerBrushedPieceCounts) {
  const Mesh ball = surfaces::icosphere(3);
  const Mesh mesh = surfaces::together(ball, surfaces::moved(ball, {2.2, 0, 0}));
  const Surface surface(mesh);
  const auto patch = select_patch(surface, {.strokes = {{{0, 1, 0}, {0.7, 0.7, 0}, {1.6, 0.7, 0}}}, .radius = 0.2});
  ASSERT_TRUE(patch) << refusal(patch);
  EXPECT_TRUE(hangs_together(mesh, *patch));
  EXPECT_LT(patch->back().index(), ball.triangles.size());
}

TEST(PatchBrush, ABrushLargerThanTheModelSelectsAllOfIt) {
  const Mesh mesh = surfaces::icosphere(2);
  const Surface surface(mesh);
  EXPECT_EQ(select_patch(surface, {.strokes = {{{0, 0, 1}}}, .radius = 50})->size(), mesh.triangles.size());
}

TEST(PatchBrush, OnABoundaryTakesTheSideThatIsThere) {
  const Mesh mesh = table_with_a_block();
  const Surface surface(mesh);
  const auto patch = select_patch(surface, {.strokes = {{{1, 0, 0}, {1, 0.1, 0}}}, .radius = 0.1});
  ASSERT_TRUE(patch) << refusal(patch);
  EXPECT_GT(patch->size(), 50U);
  EXPECT_TRUE(hangs_together(mesh, *patch));
}

TEST(PatchBrush, OneTriangleIsAPatch) {
  const Mesh mesh = surfaces::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  const Surface surface(mesh);
  EXPECT_EQ(*select_patch(surface, {.strokes = {{{0.1, 0.1, 0}}}, .radius = 1e-6}), std::vector{FaceId(0)});
}

TEST(PatchBrush, ReachesOverEdgesOfThreeFacesAndBesideFacesWithoutAnArea) {
  Mesh mesh = surfaces::mesh_of({{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.5, -1, 0}, {0.5, 0, 1}},
                                {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {0, 0, 1}, {0, 1, 1}});
  const Surface surface(mesh);
  const auto patch = select_patch(surface, {.strokes = {{{0.5, 0, 0}}}, .radius = 0.6});
  ASSERT_TRUE(patch) << refusal(patch);
  EXPECT_EQ(patch->size(), 3);
}

TEST(PatchBrush, StrokesThatCannotBeAreRefusedByName) {
  const Mesh mesh = surfaces::icosphere(2);
  const Surface surface(mesh);
  const auto said = [&](const PatchStrokes& drawn) { return refusal(select_patch(surface, drawn)); };
  EXPECT_NE(said({.strokes = {{{0, 0, 1}}, {{0, 0, 2}}}, .radius = 0.1}).find("strokes[1], point 0"),
            std::string::npos);
  EXPECT_NE(said({.strokes = {{}}, .radius = 0.1}).find("strokes[0]"), std::string::npos);
  EXPECT_NE(said({.strokes = {}, .radius = 0.1}).find("stroke"), std::string::npos);
  EXPECT_NE(said({.strokes = {{{0, 0, 1}}}, .radius = 0}).find("radius"), std::string::npos);
  EXPECT_NE(said({.strokes = {{{0, 0, 1}}}, .radius = 0.2, .background = {{{0, 0, 1}}}}).find("background"),
            std::string::npos);
  const Mesh none;
  EXPECT_NE(refusal(select_patch(Surface(none), {.strokes = {{{0, 0, 1}}}, .radius = 1})).find("no face"),
            std::string::npos);
}

TEST(PatchBrush, SelectsPointsOnItsOwnSideOfASheet) {
  PointSet points;
  for (const double up : {1.0, -1.0})
    for (int i = 0; i < 11; ++i)
      for (int j = 0; j < 11; ++j) {
        points.positions.emplace_back(0.1 * i, 0.1 * j, 0.01 * up);
        points.normals.emplace_back(0, 0, up);
      }
  const auto patch = select_patch(points, {.strokes = {{{0.2, 0.5, 0.01}, {0.8, 0.5, 0.01}}}, .radius = 0.15});
  ASSERT_TRUE(patch);
  EXPECT_EQ(patch->size(), 27U);  // 9 of three rows: those at the ends lie 0.14 away
  for (const VertexId v : *patch) EXPECT_LT(v.index(), 121U);
  const auto less = select_patch(
      points, {.strokes = {{{0.2, 0.5, 0.01}, {0.8, 0.5, 0.01}}}, .radius = 0.15, .background = {{{0.8, 0.5, 0.01}}}});
  ASSERT_TRUE(less);
  EXPECT_LT(less->size(), patch->size());
  const auto message_of = [&](const PatchStrokes& drawn) { return select_patch(points, drawn).error().message; };
  EXPECT_EQ(message_of({.strokes = {{{9, 9, 9}}}, .radius = 0.1}),
            "strokes: no point lies within the radius of one; draw on the points");
  EXPECT_EQ(message_of({.strokes = {{{0.5, 0.5, 0.01}}}, .radius = 0.15, .background = {{{0.5, 0.5, 0.01}}}}),
            "background: it covers all strokes; leave some of the patch");
  EXPECT_FALSE(select_patch(points, {.strokes = {{{0, 0, 0}}}, .radius = 0}));
  EXPECT_FALSE(select_patch(points, {.strokes = {{}}, .radius = 1}));
  EXPECT_FALSE(select_patch(PointSet{}, {.strokes = {{{0, 0, 0}}}, .radius = 1}));
}

}  // namespace
}  // namespace armature::sdk
