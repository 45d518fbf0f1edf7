#include <algorithm>
#include <filesystem>
#include <limits>
#include <string>

#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/mesh/boundary.h>
#include <armature/sdk/mesh/components.h>
#include <armature/sdk/mesh/report.h>
#include <gtest/gtest.h>

#include "tests/sdk/mesh/surfaces.h"

namespace armature::sdk {
namespace {

using surfaces::triangle;

MeshReport report_of(const Mesh& mesh) {
  return analyse(mesh).value();
}

/// Two squares that share the vertex 0 alone.
Mesh bow_tie() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {-1, 0, 0}, {-1, -1, 0}, {0, -1, 0}};
  mesh.triangles = {triangle(0, 1, 2), triangle(0, 2, 3), triangle(0, 4, 5), triangle(0, 5, 6)};
  return mesh;
}

/// Three triangles around the edge 0-1.
Mesh three_pages() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
  mesh.triangles = {triangle(0, 1, 2), triangle(0, 1, 3), triangle(0, 1, 4)};
  return mesh;
}

/// A strip of `cells` squares, closed to a ring with half a turn.
Mesh moebius(std::size_t cells) {
  Mesh mesh;
  for (std::size_t i = 0; i < cells; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(cells);
    for (const double side : {-0.3, 0.3}) {
      const double r = 1 + side * std::cos(angle / 2);
      mesh.positions.emplace_back(r * std::cos(angle), r * std::sin(angle), side * std::sin(angle / 2));
    }
  }
  for (std::size_t i = 0; i < cells; ++i) {
    const bool last = i + 1 == cells;
    const std::size_t a = 2 * i;
    const std::size_t c = last ? 1 : a + 2;
    const std::size_t d = last ? 0 : a + 3;
    mesh.triangles.push_back(triangle(a, c, d));
    mesh.triangles.push_back(triangle(a, d, a + 1));
  }
  return mesh;
}

TEST(Report, OfASphereIsClosedOrientedAndWithoutHandles) {
  const MeshReport report = report_of(surfaces::icosphere(3));
  EXPECT_EQ(report.vertices, 642U);
  EXPECT_EQ(report.faces, 1280U);
  EXPECT_EQ(report.edges, 1920U);
  EXPECT_EQ(report.components, 1U);
  EXPECT_TRUE(report.closed);
  EXPECT_TRUE(report.oriented);
  EXPECT_EQ(report.genus, 0);
  EXPECT_EQ(report.inward_faces, 0U);
  EXPECT_NEAR(report.volume, 4 * std::numbers::pi / 3, 0.05);
  EXPECT_NEAR(report.area, 4 * std::numbers::pi, 0.1);
}

TEST(Report, CountsHandlesOverAllComponents) {
  EXPECT_EQ(report_of(surfaces::torus(3, 1)).genus, 1);
  const Mesh three =
      surfaces::together(surfaces::together(surfaces::torus(3, 1), surfaces::torus(8, 1)), surfaces::icosphere(1));
  const MeshReport report = report_of(three);
  EXPECT_EQ(report.components, 3U);
  EXPECT_EQ(report.genus, 2);
}

TEST(Report, ClosesHolesWithDiscsBeforeItCountsHandles) {
  const MeshReport report = report_of(surfaces::cylinder(1, 1));
  EXPECT_FALSE(report.closed);
  EXPECT_EQ(report.boundary_loops, 2U);
  EXPECT_EQ(report.boundary_edges, 120U);
  EXPECT_EQ(report.genus, 0);
}

TEST(Report, AMoebiusStripHasOneBoundaryAndNoGenus) {
  const MeshReport report = report_of(moebius(20));
  EXPECT_EQ(report.boundary_loops, 1U);
  EXPECT_FALSE(report.oriented);
  EXPECT_FALSE(report.genus);
}

TEST(Report, AFaceTurnedOverBreaksTheOrientationButNotTheGenus) {
  Mesh sphere = surfaces::icosphere(2);
  std::swap(sphere.triangles[7][0], sphere.triangles[7][1]);
  const MeshReport report = report_of(sphere);
  EXPECT_FALSE(report.oriented);
  EXPECT_TRUE(report.closed);
  EXPECT_EQ(report.genus, 0);
  EXPECT_EQ(report.inward_faces, 1U);
}

TEST(Report, WingsThatTouchInAVertexAreOneComponentOfTwoLoops) {
  const MeshReport report = report_of(bow_tie());
  EXPECT_EQ(report.components, 1U);
  EXPECT_EQ(report.boundary_loops, 2U);
  EXPECT_EQ(report.nonmanifold_vertices, 1U);
  EXPECT_EQ(report.nonmanifold_edges, 0U);
  EXPECT_FALSE(report.genus);
}

TEST(Report, PagesOfABookBranchInAnEdge) {
  const MeshReport report = report_of(three_pages());
  EXPECT_EQ(report.nonmanifold_edges, 1U);
  EXPECT_EQ(report.nonmanifold_vertices, 0U);
  EXPECT_EQ(report.boundary_edges, 6U);
  EXPECT_EQ(report.boundary_loops, 3U);
  EXPECT_FALSE(report.closed);
  EXPECT_FALSE(report.genus);
}

TEST(Report, CountsWhatIsDegenerateDuplicateOrUnused) {
  Mesh mesh = surfaces::cube();
  mesh.positions.emplace_back(0.5, 0, 0);                                                        // 8, on an edge
  mesh.positions.emplace_back(7, 7, 7);                                                          // 9
  mesh.triangles.push_back(triangle(0, 1, 8));                                                   // corners on a line
  mesh.triangles.push_back(triangle(3, 3, 4));                                                   // names a vertex twice
  mesh.triangles.push_back({mesh.triangles[0][1], mesh.triangles[0][0], mesh.triangles[0][2]});  // a second time
  const MeshReport report = report_of(mesh);
  EXPECT_EQ(report.degenerate_faces, 2U);
  EXPECT_EQ(report.duplicate_faces, 1U);
  EXPECT_EQ(report.unused_vertices, 1U);
  EXPECT_EQ(report.components, 1U);
}

TEST(Report, DegenerateDoesNotDependOnTheUnitOfLength) {
  for (const double scale : {1e-150, 1e-6, 1e6, 1e150}) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {scale, 0, 0}, {0.3 * scale, 1e-6 * scale, 0}, {0.3 * scale, 0, 0}};
    mesh.triangles = {triangle(0, 1, 2), triangle(0, 1, 3)};
    EXPECT_FALSE(is_degenerate(mesh, FaceId(0))) << scale;
    EXPECT_TRUE(is_degenerate(mesh, FaceId(1))) << scale;
  }
}

TEST(Report, OfNothingIsEmpty) {
  const MeshReport report = report_of(Mesh{});
  EXPECT_EQ(report.components, 0U);
  EXPECT_FALSE(report.closed);
  EXPECT_EQ(report.bbox_diagonal, 0);
}

TEST(Report, StopsWhenAsked) {
  std::stop_source stop;
  stop.request_stop();
  const auto report = analyse(surfaces::cube(), {.stop = stop.get_token()});
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().kind, ErrorKind::Cancelled);
}

TEST(BoundaryLoops, WalkInTheDirectionOfTheirFaces) {
  Mesh square;
  square.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  square.triangles = {triangle(0, 1, 2), triangle(0, 2, 3)};
  const auto loops = find_boundary_loops(square, Adjacency(square));
  ASSERT_EQ(loops.size(), 1U);
  EXPECT_TRUE(loops[0].closed);
  EXPECT_EQ(loops[0].vertices, (std::vector<VertexId>{VertexId(0), VertexId(1), VertexId(2), VertexId(3)}));
}

TEST(BoundaryLoops, BetweenBranchesAreChains) {
  const Mesh pages = three_pages();
  for (const BoundaryLoop& loop : find_boundary_loops(pages, Adjacency(pages))) {
    EXPECT_FALSE(loop.closed);
    EXPECT_EQ(loop.vertices.size(), 3U);
  }
}

TEST(Components, HangTogetherByVerticesOrByEdges) {
  const Mesh mesh = bow_tie();
  const Adjacency adjacency(mesh);
  EXPECT_EQ(find_components(mesh, adjacency, LinkedBy::Vertices).count, 1U);
  const Components wings = find_components(mesh, adjacency, LinkedBy::Edges);
  EXPECT_EQ(wings.count, 2U);
  EXPECT_EQ(wings.of_face, (std::vector<std::uint32_t>{0, 0, 1, 1}));
}

TEST(Validation, NamesTheFirstElementThatIsWrong) {
  Mesh mesh = surfaces::cube();
  EXPECT_TRUE(validate(mesh));
  mesh.triangles[3][1] = VertexId(8);
  EXPECT_EQ(validate(mesh).error().message, "mesh, face 3: expected corners below 8");
  mesh.positions[5].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(validate(mesh).error().message, "mesh, vertex 5: expected finite coordinates");
}

/// What is known of models, or counted by other programs.
struct Known {
  const char* file;
  std::size_t vertices, faces, components, nonmanifold_edges;
  bool closed, oriented;
  std::optional<std::int64_t> genus;
};

class KnownModels : public testing::TestWithParam<Known> {};

TEST_P(KnownModels, AreReportedAsTheyAre) {
  const Known& known = GetParam();
  const auto path = std::filesystem::path("../shared/data/meshes") / known.file;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const auto mesh = read_mesh(path);
  ASSERT_TRUE(mesh) << mesh.error().message;
  const MeshReport report = report_of(*mesh);
  EXPECT_EQ(report.vertices, known.vertices);
  EXPECT_EQ(report.faces, known.faces);
  EXPECT_EQ(report.components, known.components);
  EXPECT_EQ(report.nonmanifold_edges, known.nonmanifold_edges);
  EXPECT_EQ(report.closed, known.closed);
  EXPECT_EQ(report.oriented, known.oriented);
  EXPECT_EQ(report.genus, known.genus);
}

INSTANTIATE_TEST_SUITE_P(Report, KnownModels,
                         testing::Values(Known{"elephant_24955.off", 24955, 49918, 1, 0, true, true, 3},
                                         Known{"camel_mc_2020.off", 2020, 4040, 1, 0, true, true, 1},
                                         Known{"as_WusonOBJ.obj", 2117, 3732, 51, 0, false, true, {}},
                                         Known{"igl_truck.obj", 2956, 4770, 50, 54, false, false, {}},
                                         Known{"tm_cycloidal.ply", 21384, 43368, 100, 242, true, true, {}},
                                         Known{"gc_moebius.obj", 280, 448, 1, 0, false, false, {}},
                                         Known{"gc_hourglass_ico.obj", 23, 40, 1, 0, true, true, {}}),
                         [](const auto& known) {
                           std::string name = known.param.file;
                           name.resize(name.find('.'));
                           return name;
                         });

}  // namespace
}  // namespace armature::sdk
