#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>

#include <Eigen/Dense>
#include <armature/sdk/expansion/patch_expansion.h>
#include <armature/sdk/expansion/patch_map.h>
#include <gtest/gtest.h>

#include "sdk/expansion/face_graph.h"
#include "sdk/expansion/patch_places.h"
#include "sdk/expansion/patch_registration.h"
#include "sdk/expansion/sample_grid.h"
#include "tests/sdk/mesh/surfaces.h"
#include "tests/sdk/selection/table.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;
using table::faces_within;

/// A table of side 2 with bumps of one shape at three places, and one that is lower.
Mesh table_with_bumps() {
  return surfaces::over({90, 90, false, false, 0}, [](double i, double j) {
    const Vector3d p(2 * i - 1, 2 * j - 1, 0);
    double z = 0;
    for (const Vector3d& bump :
         {Vector3d(-0.5, -0.5, 0.2), Vector3d(0.5, -0.5, 0.2), Vector3d(-0.5, 0.5, 0.2), Vector3d(0.5, 0.5, 0.08)})
      z += bump.z() * std::exp(-std::pow((p - bump).head<2>().norm() / 0.1, 2));
    return Vector3d(p.x(), p.y(), z);
  });
}

VertexId vertex_near(const Mesh& mesh, const Vector3d& point) {
  const auto nearest = std::ranges::min_element(mesh.positions, {},
                                                [&](const Vector3d& p) { return (p - point).head<2>().squaredNorm(); });
  return VertexId(nearest - mesh.positions.begin());
}

Eigen::Matrix3d linear(const Match& match) {
  return match.reference_from_match.topLeftCorner<3, 3>();
}

TEST(PatchContexts, AreAlikeWhereTheSurfaceIs) {
  const Mesh mesh = table_with_bumps();
  const Surface surface(mesh);
  const auto contexts = PatchContexts::build(surface, 0.25);
  ASSERT_TRUE(contexts);
  const VertexId bump = vertex_near(mesh, {-0.5, -0.5, 0});
  const Histogram context = contexts->of(bump);
  double sum = 0;
  for (const float mass : context) sum += mass;
  EXPECT_NEAR(sum, 1, 1e-5);
  const auto similarity = contexts->similarity_to(context);
  ASSERT_TRUE(similarity);
  EXPECT_NEAR((*similarity)[bump.index()], 1, 1e-6);
  EXPECT_GT((*similarity)[vertex_near(mesh, {0.5, -0.5, 0}).index()], 0.95);
  EXPECT_LT((*similarity)[vertex_near(mesh, {0.5, 0.5, 0}).index()], 0.8);
  EXPECT_LT((*similarity)[vertex_near(mesh, {0, 0, 0}).index()], 0.6);
  EXPECT_FALSE(PatchContexts::build(surface, 0));
  const auto short_of_bins = contexts->similarity_to(std::span(context).first(99));
  ASSERT_FALSE(short_of_bins);
  EXPECT_EQ(short_of_bins.error().message, "expected a context of 100 bins, found 99");
}

TEST(PatchPlaces, AreMaximaThatNoBetterOneIsNear) {
  const Mesh mesh = surfaces::paraboloid(0, 0, 40);
  const Surface surface(mesh);
  std::vector<float> similarity(mesh.positions.size());
  const VertexId best = vertex_near(mesh, {0, 0, 0});
  const VertexId beside = vertex_near(mesh, {0.2, 0.1, 0});
  const VertexId apart = vertex_near(mesh, {-0.5, 0.4, 0});
  similarity[best.index()] = 0.9F;
  similarity[beside.index()] = 0.8F;
  similarity[apart.index()] = 0.7F;
  const auto centres = [&](double radius) {
    std::vector<VertexId> found;
    for (const PatchPlace& place : maxima(surface, similarity, radius, 1)) found.push_back(place.centre);
    return found;
  };
  EXPECT_EQ(centres(0.1), (std::vector{best, beside, apart}));
  EXPECT_EQ(centres(0.4), (std::vector{best, apart}));
  EXPECT_EQ(centres(9), std::vector{best});
}

TEST(PatchPlaces, OfManySizesCountTwice) {
  const Mesh mesh = surfaces::paraboloid(0, 0, 40);
  const Surface surface(mesh);
  const VertexId one = vertex_near(mesh, {0, 0, 0});
  const VertexId beside = vertex_near(mesh, {0.05, 0, 0});
  const VertexId apart = vertex_near(mesh, {-0.5, 0.4, 0});
  const std::vector<PatchPlace> places = {{one, 1, 0.7F}, {beside, 1.5, 0.9F}, {apart, 2, 0.6F}, {one, 2, 0.8F}};
  const RankedPlaces found = ranked(surface, places, 0.2);
  EXPECT_EQ(found.first, (std::vector<std::size_t>{1, 3, 2}));
  EXPECT_EQ(found.others, std::vector<std::size_t>{0});
  EXPECT_EQ(ranked(surface, places, 0.01).first.size(), 4);
  EXPECT_TRUE(ranked(surface, {}, 1).first.empty());
}

TEST(PatchContexts, AreTheSameOneByOneAndAllAtOnce) {
  const Mesh mesh = surfaces::icosphere(3);
  const Surface surface(mesh);
  const auto contexts = PatchContexts::build(surface, 0.4);
  ASSERT_TRUE(contexts);
  const auto all = contexts->of_all();
  ASSERT_TRUE(all);
  constexpr std::size_t kShares = PatchContexts::kDistances * PatchContexts::kAngles;
  ASSERT_EQ(all->size(), mesh.positions.size() * kShares);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Histogram one = contexts->of(VertexId(v));
    ASSERT_TRUE(std::equal(one.begin(), one.end(), all->begin() + static_cast<std::ptrdiff_t>(v * kShares))) << v;
  }
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(contexts->of_all({.stop = stop.get_token()}).error().kind, ErrorKind::Cancelled);
}

TEST(PatchContexts, OfAFlatSurfaceGrowWithTheDistance) {
  const Mesh mesh = surfaces::paraboloid(0, 0, 80);
  const Surface surface(mesh);
  const Histogram context = PatchContexts::build(surface, 0.5)->of(vertex_near(mesh, {0, 0, 0}));
  for (std::size_t row = 0; row < PatchContexts::kDistances; ++row) {
    const double ring = (2 * static_cast<double>(row) + 1) / 100;  // its share of the disc
    EXPECT_NEAR(context[row * PatchContexts::kAngles], ring, 0.03) << row;
    for (std::size_t column = 1; column < PatchContexts::kAngles; ++column)
      EXPECT_EQ(context[row * PatchContexts::kAngles + column], 0);
  }
}

TEST(SampleGrid, KnowsWhatIsNearAPoint) {
  const Mesh mesh = table_with_bumps();
  std::vector<FaceId> all;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) all.emplace_back(f);
  const SampleGrid grid(samples_of(mesh, all, 1e-3), Vector3d::Zero(), 1.2);  // cells of side 0.1
  for (const Vector3d& point : {Vector3d(0, 0, 0.05), Vector3d(0.9, -0.9, -0.2), Vector3d(-0.5, -0.5, 0.2)}) {
    const SurfaceSample* near = grid.near(point);
    ASSERT_NE(near, nullptr);
    EXPECT_LT((near->point - point).norm(), 0.3);
    EXPECT_GT(near->normal.z(), 0.3);
    EXPECT_NEAR(near->normal.norm(), 1, 1e-12);
  }
  EXPECT_EQ(grid.near({0, 0, 1}), nullptr);
  EXPECT_EQ(grid.near({0, 0, 9}), nullptr);
}

TEST(FaceGraph, FindsTheClosestPointDownhillFromWhatIsNearIt) {
  const Mesh mesh = table_with_bumps();
  const Surface surface(mesh);
  const FaceGraph graph(surface);
  for (std::size_t v = 0; v < mesh.positions.size(); v += 17) {
    const Vector3d point = mesh.positions[v] + 0.02 * surface.vertex_normals[v] + Vector3d(0.007, 0.003, 0);
    const SurfacePoint closest = surface.tree.closest(point);
    const SurfacePoint beside = surface.tree.closest(point + Vector3d(0.06, -0.05, 0));
    const SurfacePoint found = graph.closest_from(beside.face, point);
    EXPECT_NEAR(found.distance, closest.distance, 1e-12) << point.transpose();
    EXPECT_NEAR((found.point - point).norm(), found.distance, 1e-12);
    const auto& [a, b, c] = mesh.triangle(found.face);
    const Vector3d there = found.barycentric[0] * mesh.position(a) + found.barycentric[1] * mesh.position(b) +
                           found.barycentric[2] * mesh.position(c);
    EXPECT_NEAR((there - found.point).norm(), 0, 1e-12);
  }
}

TEST(FaceGraph, LeadsAcrossTheMeshButNeverAwayFromThePoint) {
  const Mesh mesh = surfaces::icosphere(4);
  const Surface surface(mesh);
  const FaceGraph graph(surface);
  const Vector3d point(0, 0.1, 1.5);
  for (std::size_t f = 0; f < mesh.triangles.size(); f += 37)
    EXPECT_NEAR(graph.closest_from(FaceId(f), point).distance, surface.tree.closest(point).distance, 1e-12) << f;
}

TEST(FaceGraph, OfFacesWithoutAnAreaOrEdgesTakesWhatIsThere) {
  const Mesh mesh = surfaces::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}}, {{0, 1, 2}, {0, 0, 1}, {0, 1, 3}});
  const Surface surface(mesh);
  const FaceGraph graph(surface);
  for (std::size_t f = 0; f < 3; ++f) {
    const SurfacePoint found = graph.closest_from(FaceId(f), {0.25, 0.25, 3});
    ASSERT_TRUE(found.face.valid());
    EXPECT_NEAR(found.distance, 3, 0.02) << f;
  }
}

TEST(PatchReference, ReachesAMatchWhoseCentreIsLifted) {
  Mesh mesh = table_with_bumps();
  const auto patch = faces_within(mesh, 0.2, {-0.5, -0.5});
  // One vertex, so far up that no face around it lies near the patch.
  mesh.positions[vertex_near(mesh, {0.5, -0.5, 0}).index()].z() += 0.3;
  const Surface surface(mesh);
  const FaceGraph graph(surface);
  const PatchReference reference(graph, patch, *patch_ball(surface, patch));
  PatchFit there;
  there.target_from_reference(0, 3) = 1;
  const auto match = reference.extent(graph, there);
  EXPECT_GT(table::overlap(mesh, match, faces_within(mesh, 0.2, {0.5, -0.5})), 0.85);
}

TEST(PatchExpansion, FindsTheLikesOfABump) {
  const Mesh mesh = table_with_bumps();
  const Surface surface(mesh);
  const auto patch = faces_within(mesh, 0.2, {-0.5, -0.5});
  const auto expansion = expand_patch(surface, patch);
  ASSERT_TRUE(expansion);
  ASSERT_GE(expansion->size(), 3);
  EXPECT_EQ(expansion->reference(), patch);
  for (const Match& match : expansion->first(2)) {
    EXPECT_GT(match.score, 0.9);
    EXPECT_NEAR(static_cast<double>(match.faces.size()), static_cast<double>(patch.size()), 10);
    EXPECT_NEAR(linear(match).determinant(), 1, 0.05);
    EXPECT_NE(match.reason.find("surroundings"), std::string::npos);
  }
  EXPECT_LT(expansion->first(3)[2].score, expansion->first(2)[1].score - 0.1);
  for (const Rejected& rejected : expansion->rejected()) EXPECT_FALSE(rejected.reason.empty());
}

TEST(PatchExpansion, SaysWhereAnotherTurnFitsAsWell) {
  const Mesh mesh = table_with_bumps();
  const auto expansion = expand_patch(Surface(mesh), faces_within(mesh, 0.2, {-0.5, -0.5}));
  ASSERT_TRUE(expansion);
  ASSERT_GE(expansion->size(), 1);
  EXPECT_NE(expansion->first(1)[0].reason.find("turned otherwise"), std::string::npos);  // the bump is round
}

/// A table with a ridge that has a knob towards one end, so far aside, and the same half turned; vertices are moved up
/// or down by up to some noise.
Mesh table_with_ridges(double aside, double noise) {
  std::mt19937 random(1);
  return surfaces::over({70, 70, false, false, 0}, [&](double i, double j) {
    const Vector3d p(2 * i - 1, 2 * j - 1, 0);
    double z = 0;
    for (const double side : {-1.0, 1.0}) {
      const double x = side * (p.x() - 0.5 * side);
      const double y = side * p.y();
      z += 0.15 * std::exp(-std::pow(x / 0.2, 2) - std::pow(y / 0.1, 2));
      z += 0.06 * std::exp(-(std::pow(x - 0.12, 2) + std::pow(y - aside, 2)) / 0.005);
    }
    return Vector3d(p.x(), p.y(), z + noise * (static_cast<double>(random()) / 2147483648.0 - 1));
  });
}

TEST(PatchExpansion, SaysWhereAMirrorImageFitsAsWellAndNoTurn) {
  for (const bool symmetric : {true, false}) {
    const Mesh mesh = table_with_ridges(symmetric ? 0 : 0.08, 0);
    const auto expansion = expand_patch(Surface(mesh), faces_within(mesh, 0.3, {-0.5, 0}));
    ASSERT_TRUE(expansion);
    ASSERT_GE(expansion->size(), 1);
    const std::string& reason = expansion->first(1)[0].reason;
    EXPECT_EQ(reason.find("turned"), std::string::npos) << reason;
    EXPECT_EQ(reason.find("nearly as well mirrored") != std::string::npos, symmetric) << reason;
  }
}

TEST(PatchExpansion, TellsAHalfTurnInNoise) {
  const Mesh mesh = table_with_ridges(0, 0.006);  // up to 2 % of the patch's radius
  const auto expansion = expand_patch(Surface(mesh), faces_within(mesh, 0.3, {-0.5, 0}));
  ASSERT_TRUE(expansion);
  ASSERT_GE(expansion->size(), 1);
  const Match& match = expansion->first(1)[0];
  EXPECT_FALSE(match.mirrored);
  EXPECT_LT(linear(match)(0, 0), -0.9);
  EXPECT_LT(linear(match)(1, 1), -0.9);
}

TEST(PatchExpansion, AsksOneMeshWithAPatchOfAnother) {
  const Mesh mesh = table_with_bumps();
  const Surface surface(mesh);
  const Mesh other = surfaces::moved(mesh, {7, 8, 9});
  const Surface of_patch(other);
  const auto expansion = expand_patch(surface, of_patch, faces_within(other, 0.2, {6.5, 7.5}));
  ASSERT_TRUE(expansion);
  for (const Match& match : expansion->first(3)) EXPECT_GT(match.score, 0.9);
  const Vector3d shift = expansion->first(1)[0].reference_from_match.topRightCorner<3, 1>();
  EXPECT_GT(shift.norm(), 5);
}

TEST(PatchExpansion, FindsOtherSizesWhenAsked) {
  Mesh mesh = table_with_bumps();
  mesh = surfaces::together(mesh, surfaces::moved(table_with_bumps(), {9, 0, 0}, 1.6));
  const Surface surface(mesh);
  const auto expansion = expand_patch(surface, faces_within(mesh, 0.2, {-0.5, -0.5}), {.scales = {1, 1.26, 1.587}});
  ASSERT_TRUE(expansion);
  ASSERT_GE(expansion->size(), 5);
  const auto best = expansion->first(5);
  EXPECT_EQ(
      std::ranges::count_if(
          best, [](const Match& match) { return std::abs(std::cbrt(linear(match).determinant()) - 1 / 1.6) < 0.05; }),
      3);
}

TEST(PatchExpansion, SaysWhatItDidNotLookAt) {
  const Mesh mesh = table_with_bumps();
  const Surface surface(mesh);
  const auto patch = faces_within(mesh, 0.2, {-0.5, -0.5});
  const auto with = [&](std::string_view words, const Expansion& expansion) {
    return std::ranges::count_if(expansion.rejected(), [&](const Rejected& rejected) {
      return rejected.face.valid() && rejected.reason.find(words) != std::string::npos;
    });
  };
  const auto all = expand_patch(surface, patch);
  const auto one = expand_patch(surface, patch, {.most = 1});
  const auto sizes = expand_patch(surface, patch, {.most = 1, .scales = {0.8, 0.9, 1}});
  ASSERT_TRUE(all && one && sizes);
  EXPECT_EQ(with("not among the best", *all), 0);
  EXPECT_EQ(one->size(), 1);
  EXPECT_EQ(one->size() + one->rejected().size(), all->size() + all->rejected().size());
  EXPECT_GE(with("alike: not among the best 1", *one), 2);
  EXPECT_GT(with("alike: not among the best 1", *sizes), with("alike: not among the best 1", *one));
  EXPECT_GE(with("more alike at two other sizes", *sizes), 1);
}

TEST(PatchExpansion, LooksAtAllThatThereIsWhenAskedForMore) {
  const Mesh mesh = table_with_bumps();
  const Surface surface(mesh);
  const auto patch = faces_within(mesh, 0.2, {-0.5, -0.5});
  const auto some = expand_patch(surface, patch, {.most = 1000});
  const auto all = expand_patch(surface, patch, {.most = std::numeric_limits<std::size_t>::max()});
  ASSERT_TRUE(some && all);
  EXPECT_GE(all->size(), 3);
  EXPECT_EQ(all->size(), some->size());
}

TEST(PatchExpansion, ARejectedCopyTakesItsLikesAlongInNoise) {
  std::mt19937 random(3);
  Mesh mesh = table_with_bumps();
  for (Vector3d& p : mesh.positions) p.z() += 0.012 * (static_cast<double>(random()) / 2147483648.0 - 1);
  auto expansion = expand_patch(Surface(mesh), faces_within(mesh, 0.2, {-0.5, -0.5}));
  ASSERT_TRUE(expansion);
  ASSERT_GE(expansion->size(), 2);
  EXPECT_GT(expansion->first(2)[1].score, 0.9);
  expansion->reject(0);
  EXPECT_LT(expansion->first(1)[0].score, 0.3);  // contexts whose bins are not spread leave the other copy at 0.49
}

TEST(PatchExpansion, IsTheSameOnEveryRun) {
  const Mesh mesh = table_with_bumps();
  const Surface surface(mesh);
  const auto patch = faces_within(mesh, 0.2, {-0.5, -0.5});
  const auto a = expand_patch(surface, patch);
  const auto b = expand_patch(surface, patch);
  ASSERT_TRUE(a && b);
  ASSERT_EQ(a->size(), b->size());
  for (std::size_t i = 0; i < a->size(); ++i) {
    EXPECT_EQ(a->first(i + 1)[i].faces, b->first(i + 1)[i].faces);
    EXPECT_EQ(a->first(i + 1)[i].score, b->first(i + 1)[i].score);
  }
}

TEST(PatchExpansion, APatchThatIsTheWholeModelHasNoLikes) {
  const Mesh mesh = surfaces::icosphere(3);
  const Surface surface(mesh);
  std::vector<FaceId> all;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) all.emplace_back(f);
  const auto expansion = expand_patch(surface, all);
  ASSERT_TRUE(expansion) << expansion.error().message;
  EXPECT_EQ(expansion->size(), 0);
}

TEST(PatchExpansion, DegenerateMeshesGiveAResultOrAMessage) {
  const Mesh one = surfaces::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  const auto alone = expand_patch(Surface(one), std::vector{FaceId(0)});
  ASSERT_TRUE(alone) << alone.error().message;
  EXPECT_EQ(alone->size(), 0);
  const Mesh fan = surfaces::mesh_of({{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.5, -1, 0}, {0.5, 0, 1}},
                                     {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {0, 0, 1}});
  EXPECT_TRUE(expand_patch(Surface(fan), std::vector{FaceId(1)}));
  EXPECT_TRUE(expand_patch(Surface(fan), std::vector{FaceId(3)}));  // which names a vertex twice
  const Mesh side = surfaces::mesh_of({{0, 0, 0}, {1, 0, 0}}, {{0, 0, 1}});
  EXPECT_TRUE(expand_patch(Surface(side), std::vector{FaceId(0)}));
  const Mesh point = surfaces::mesh_of({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {{0, 1, 2}});
  EXPECT_FALSE(expand_patch(Surface(point), std::vector{FaceId(0)}));
  EXPECT_FALSE(expand_patch(Surface(one), std::vector<FaceId>{}));
  EXPECT_FALSE(expand_patch(Surface(one), std::vector{FaceId(7)}));
  EXPECT_FALSE(expand_patch(Surface(one), std::vector{FaceId(0)}, {.scales = {}}));
}

TEST(PatchExpansion, StopsWhenAsked) {
  const Mesh mesh = table_with_bumps();
  std::stop_source stop;
  stop.request_stop();
  const auto expansion = expand_patch(Surface(mesh), std::vector{FaceId(0)}, {}, {.stop = stop.get_token()});
  ASSERT_FALSE(expansion);
  EXPECT_EQ(expansion.error().kind, ErrorKind::Cancelled);
}

TEST(PatchExpansion, StopsWhileItLaysThePatch) {
  const Mesh mesh = table_with_bumps();
  std::stop_source stop;
  const auto at_once = [&](std::string_view step, double) {
    if (step.starts_with("laying")) stop.request_stop();
  };
  const auto expansion = expand_patch(Surface(mesh), faces_within(mesh, 0.2, {-0.5, -0.5}), {},
                                      {.stop = stop.get_token(), .progress = at_once});
  ASSERT_FALSE(expansion);
  EXPECT_EQ(expansion.error().kind, ErrorKind::Cancelled);
}

}  // namespace
}  // namespace armature::sdk
