#include <algorithm>
#include <cmath>

#include <armature/sdk/selection/boundary.h>
#include <gtest/gtest.h>

#include "sdk/selection/min_cut.h"
#include "tests/sdk/selection/table.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;
using table::faces_within;
using table::middle;
using table::overlap;
using table::table_with_a_block;

SurfacePoint at(const Surface& surface, const Vector3d& point) {
  return surface.tree.closest(point);
}

bool contains(const std::vector<FaceId>& faces, const SurfacePoint& point) {
  return std::ranges::binary_search(faces, point.face);
}

std::vector<FaceId> snapped_boundary(const Surface& surface, std::span<const FaceId> region, double width) {
  return snap_boundary(surface, region, width).value();
}

std::vector<FaceId> dragged_boundary(const Surface& surface, std::span<const FaceId> region, const BoundaryDrag& drag) {
  return drag_boundary(surface, region, drag).value();
}

TEST(SnapBoundary, IsCancelled) {
  const Mesh mesh = table_with_a_block();
  const Surface surface(mesh);
  const auto block = faces_within(mesh, 0.45);
  std::stop_source stop;
  stop.request_stop();
  const Task task{.stop = stop.get_token()};
  const auto snapped = snap_boundary(surface, block, 0.25, task);
  ASSERT_FALSE(snapped);
  EXPECT_EQ(snapped.error().kind, ErrorKind::Cancelled);
  const auto dragged = drag_boundary(
      surface, block, {.from = at(surface, {0.4, 0, 0}), .to = at(surface, {0.6, 0, 0}), .snap = 0.1}, task);
  ASSERT_FALSE(dragged);
  EXPECT_EQ(dragged.error().kind, ErrorKind::Cancelled);
}

TEST(MinCut, EndsWhereverItIsStopped) {
  MinCut cut(3);
  cut.join(0, 1, 2);
  cut.join(1, 2, 1);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(cut.source_side(0, 2, {.stop = stop.get_token()}).size(), 3U);
  EXPECT_EQ(cut.source_side(0, 2), (std::vector<bool>{true, true, false}));
}

TEST(SnapBoundary, FindsTheValleyAroundABlock) {
  const Mesh mesh = table_with_a_block();
  const Surface surface(mesh);
  const auto block = faces_within(mesh, 0.45);
  // An oval that crosses the block's foot, and touches its upper rim: 0.2 above it.
  std::vector<FaceId> rough;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const Vector3d p = middle(mesh, FaceId(f));
    if (std::hypot(p.x() / 0.5, p.y() / 0.4) < 1) rough.emplace_back(f);
  }
  EXPECT_LT(overlap(mesh, rough, block), 0.8);
  const auto snapped = snapped_boundary(surface, rough, 0.25);
  EXPECT_GT(overlap(mesh, snapped, block), 0.95);  // the grid has no edges along the foot
  EXPECT_TRUE(snapped_boundary(surface, snapped, 0.25) == snapped);
}

TEST(SnapBoundary, LeavesWhatIsThinnerThanItsWidthAndWhatHasNoBoundary) {
  const Mesh mesh = table_with_a_block();
  const Surface surface(mesh);
  EXPECT_TRUE(snapped_boundary(surface, {}, 0.1).empty());
  const auto all = faces_within(mesh, 9);
  EXPECT_EQ(snapped_boundary(surface, all, 0.1), all);
  EXPECT_FALSE(snapped_boundary(surface, faces_within(mesh, 0.05), 0.3).empty());
  const auto dot = faces_within(mesh, 0.02);
  std::vector<FaceId> holed;
  std::ranges::set_difference(all, dot, std::back_inserter(holed));
  EXPECT_LT(snapped_boundary(surface, holed, 0.3).size(), all.size());
}

TEST(DragBoundary, PassesThroughThePointAndStaysElsewhere) {
  const Mesh mesh = table_with_a_block();
  const Surface surface(mesh);
  const auto disc = faces_within(mesh, 0.7);
  for (const double end : {0.55, 0.85}) {
    const auto dragged =
        dragged_boundary(surface, disc, {.from = at(surface, {0.7, 0, 0}), .to = at(surface, {end, 0, 0})});
    EXPECT_TRUE(contains(dragged, at(surface, {end - 0.04, 0, 0}))) << end;
    EXPECT_FALSE(contains(dragged, at(surface, {end + 0.04, 0, 0}))) << end;
    EXPECT_TRUE(contains(dragged, at(surface, {-0.67, 0, 0})));
    EXPECT_FALSE(contains(dragged, at(surface, {-0.73, 0, 0})));
    // One change, about the point.
    std::vector<FaceId> changed;
    std::ranges::set_symmetric_difference(disc, dragged, std::back_inserter(changed));
    EXPECT_GT(changed.size(), 50U);
    for (const FaceId face : changed) EXPECT_LT((middle(mesh, face) - Vector3d(0.7, 0, 0)).norm(), 0.5);
  }
}

TEST(DragBoundary, FollowsFartherWhenAsked) {
  const Mesh mesh = table_with_a_block();
  const Surface surface(mesh);
  const auto disc = faces_within(mesh, 0.7);
  const BoundaryDrag near{.from = at(surface, {0.7, 0, 0}), .to = at(surface, {0.8, 0, 0})};
  BoundaryDrag far = near;
  far.reach = 0.8;
  EXPECT_GT(dragged_boundary(surface, disc, far).size(), dragged_boundary(surface, disc, near).size() + 100);
}

TEST(DragBoundary, RunsInTheValleyThatIsNear) {
  const Mesh mesh = table_with_a_block();
  const Surface surface(mesh);
  const auto block = faces_within(mesh, 0.45);
  // The block, short of a bite out of its side; pulled to a little beyond its foot.
  auto bitten = block;
  std::erase_if(bitten, [&](FaceId face) { return middle(mesh, face).x() > 0.3; });
  BoundaryDrag pull{.from = at(surface, {0.3, 0, 0.2}), .to = at(surface, {0.48, 0, 0}), .reach = 0.9};
  const auto exactly = dragged_boundary(surface, bitten, pull);
  pull.snap = 0.1;
  const auto snapped = dragged_boundary(surface, bitten, pull);
  EXPECT_TRUE(contains(exactly, at(surface, {0.465, 0, 0})));
  EXPECT_FALSE(contains(snapped, at(surface, {0.465, 0, 0})));
  EXPECT_TRUE(contains(snapped, at(surface, {0.43, 0, 0})));
  EXPECT_GT(overlap(mesh, snapped, block), overlap(mesh, bitten, block));
}

TEST(DragBoundary, ChangesNothingWhereItCannotReach) {
  Mesh mesh = table_with_a_block();
  const Mesh lower = mesh;
  for (const auto& [a, b, c] : lower.triangles)
    mesh.triangles.push_back({VertexId(a.index() + lower.positions.size()),
                              VertexId(b.index() + lower.positions.size()),
                              VertexId(c.index() + lower.positions.size())});
  for (const Vector3d& p : lower.positions) mesh.positions.emplace_back(p - Vector3d(0, 0, 1));
  const Surface surface(mesh);
  auto disc = faces_within(mesh, 0.6);
  std::erase_if(disc, [&](FaceId face) { return middle(mesh, face).z() < -0.5; });
  EXPECT_EQ(dragged_boundary(surface, disc, {.from = at(surface, {0.6, 0, 0}), .to = at(surface, {0.6, 0, -1})}), disc);
}

TEST(Boundary, OfOneTriangleOfNothingAndWhereThreeFacesMeetIsTaken) {
  const Mesh lone = surfaces::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  const Surface alone(lone);
  const std::vector<FaceId> all = {FaceId(0)};
  EXPECT_EQ(snapped_boundary(alone, all, 1), all);
  EXPECT_EQ(dragged_boundary(alone, all, {.from = at(alone, {0, 0, 0}), .to = at(alone, {1, 0, 0}), .snap = 1}), all);

  const Mesh fan = surfaces::mesh_of({{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.5, -1, 0}, {0.5, 0, 1}},
                                     {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {0, 0, 1}});
  const Surface surface(fan);
  EXPECT_EQ(snapped_boundary(surface, all, 0.1), all);
}

}  // namespace
}  // namespace armature::sdk
