#include <cmath>
#include <filesystem>

#include <armature/sdk/distance/measure.h>
#include <armature/sdk/distance/mesh_tree.h>
#include <armature/sdk/distance/sphere_mesh_tree.h>
#include <armature/sdk/hierarchy/build.h>
#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/mesh/measures.h>
#include <armature/sdk/spheremesh/containment.h>
#include <armature/sdk/spheremesh/refine.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/sdk/mesh/surfaces.h"

namespace armature::sdk {
namespace {

using namespace surfaces;

using Eigen::Vector3d;

/// The hull of two spheres on the x axis: every direction of a fine ball goes to the farther point of the two.
Mesh tapered_capsule(const Sphere& a, const Sphere& b) {
  Mesh mesh = icosphere(5);
  for (Vector3d& p : mesh.positions) {
    const Vector3d of_a = a.centre + a.radius * p;
    const Vector3d of_b = b.centre + b.radius * p;
    p = of_a.dot(p) > of_b.dot(p) ? of_a : of_b;
  }
  return mesh;
}

/// Enough to see what a test is about.
const RefineOptions kQuick{.rounds = 2, .samples = 800};

SphereMesh level_of(const Mesh& mesh, std::size_t spheres) {
  const auto build = build_hierarchy(mesh, {.stop_at = spheres});
  EXPECT_TRUE(build.has_value());
  auto level = build->hierarchy.level(spheres);
  EXPECT_TRUE(level.has_value());
  return level ? *level : SphereMesh();
}

/// The mean distance of the mesh's vertices to the union, in units of the bounding box's diagonal.
double mean_distance(const Mesh& mesh, const SphereMesh& shape) {
  const SphereMeshTree tree(shape);
  double sum = 0;
  for (const Vector3d& p : mesh.positions) sum += std::abs(tree.signed_distance(p));
  return sum / static_cast<double>(mesh.positions.size()) / bounding_box_diagonal(mesh);
}

void expect_same(const SphereMesh& a, const SphereMesh& b) {
  ASSERT_EQ(a.spheres.size(), b.spheres.size());
  for (std::size_t k = 0; k < a.spheres.size(); ++k) {
    EXPECT_EQ(a.spheres[k].centre, b.spheres[k].centre) << k;
    EXPECT_EQ(a.spheres[k].radius, b.spheres[k].radius) << k;
  }
  EXPECT_EQ(a.edges, b.edges);
  EXPECT_EQ(a.triangles, b.triangles);
}

TEST(Refine, FindsTheSphereOfABall) {
  const Mesh mesh = icosphere(4);
  const auto fitted = refine(mesh, {.spheres = {{Vector3d(0.2, -0.1, 0.1), 0.7}}});
  ASSERT_TRUE(fitted);
  EXPECT_LT(fitted->spheres[0].centre.norm(), 1e-3);
  EXPECT_NEAR(fitted->spheres[0].radius, 1, 3e-3);  // the facets lie a little inside
}

TEST(Refine, FindsTheTwoSpheresOfATaperedCapsule) {
  const Sphere a{Vector3d(-1, 0, 0), 0.5};
  const Sphere b{Vector3d(1.5, 0, 0), 0.2};
  const Mesh mesh = tapered_capsule(a, b);
  const auto fitted = refine(mesh, {.spheres = {{Vector3d(-0.8, 0.1, 0), 0.4}, {Vector3d(1.3, 0, 0.1), 0.3}},
                                    .edges = {{SphereId(0), SphereId(1)}}});
  ASSERT_TRUE(fitted);
  EXPECT_LT((fitted->spheres[0].centre - a.centre).norm(), 5e-3);
  EXPECT_LT((fitted->spheres[1].centre - b.centre).norm(), 5e-3);
  EXPECT_NEAR(fitted->spheres[0].radius, a.radius, 5e-3);
  EXPECT_NEAR(fitted->spheres[1].radius, b.radius, 5e-3);
}

TEST(Refine, HalvesTheErrorOfADecimatedTorus) {
  const Mesh mesh = torus(1, 0.3);
  const SphereMesh start = level_of(mesh, 12);
  const auto fitted = refine(mesh, start, kQuick);
  ASSERT_TRUE(fitted);
  EXPECT_EQ(fitted->spheres.size(), start.spheres.size());
  EXPECT_LT(mean_distance(mesh, *fitted), 0.5 * mean_distance(mesh, start));
}

TEST(Refine, DoesTheSameAtEveryScaleAndPlace) {
  const Mesh mesh = torus(1, 0.3);
  const SphereMesh start = level_of(mesh, 12);
  const auto fitted = refine(mesh, start, kQuick);
  ASSERT_TRUE(fitted);
  // Powers of two round nothing off when they scale, and little when they move.
  for (const auto& [scale, place] : {std::pair(0x1p-10, 0.0), std::pair(0x1p20, 0.0), std::pair(1.0, 8.0)}) {
    const Vector3d by(place, -place, 2 * place);
    SphereMesh elsewhere = start;
    for (Sphere& s : elsewhere.spheres) s = {scale * s.centre + by, scale * s.radius};
    const auto there = refine(moved(mesh, by, scale), elsewhere, kQuick);
    ASSERT_TRUE(there);
    for (std::size_t k = 0; k < fitted->spheres.size(); ++k) {
      EXPECT_LT(((there->spheres[k].centre - by) / scale - fitted->spheres[k].centre).norm(), 1e-6);
      EXPECT_NEAR(there->spheres[k].radius / scale, fitted->spheres[k].radius, 1e-6);
    }
  }
}

TEST(Refine, DoesTheSameOnEveryRun) {
  const Mesh mesh = torus(1, 0.3);
  const SphereMesh start = level_of(mesh, 12);
  const auto once = refine(mesh, start, kQuick);
  const auto again = refine(mesh, start, kQuick);
  ASSERT_TRUE(once && again);
  expect_same(*once, *again);
}

TEST(Refine, DoesTheSameOnAnyNumberOfThreads) {
  const Mesh mesh = torus(1, 0.3);
  const SphereMesh start = level_of(mesh, 12);
  const auto refined = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return refine(mesh, start, kQuick);
  };
  const auto alone = refined(1);
  const auto together = refined(4);
  ASSERT_TRUE(alone && together);
  expect_same(*alone, *together);
}

TEST(Refine, LeavesPinnedSpheresAlone) {
  const Mesh mesh = torus(1, 0.3);
  const SphereMesh start = level_of(mesh, 12);
  const auto fitted = refine(mesh, start, {.pinned = {SphereId(3), SphereId(7)}});
  ASSERT_TRUE(fitted);
  for (const std::size_t k : {std::size_t{3}, std::size_t{7}}) {
    EXPECT_EQ(fitted->spheres[k].centre, start.spheres[k].centre);
    EXPECT_EQ(fitted->spheres[k].radius, start.spheres[k].radius);
  }
}

TEST(Refine, TakesAMeshThatIsInsideOut) {
  const auto fitted = refine(inside_out(icosphere(4)), {.spheres = {{Vector3d(0.2, -0.1, 0.1), 0.7}}});
  ASSERT_TRUE(fitted);
  EXPECT_NEAR(fitted->spheres[0].radius, 1, 3e-3);
}

TEST(Refine, ReturnsAStartWithNothingToFit) {
  const SphereMesh start{.spheres = {{Vector3d::Zero(), 1}}};
  Mesh flat;
  flat.positions.assign(3, Vector3d::Ones());
  flat.triangles = {triangle(0, 1, 2)};
  for (const Mesh& mesh : {Mesh(), flat}) {
    const auto fitted = refine(mesh, start, kQuick);
    ASSERT_TRUE(fitted);
    expect_same(*fitted, start);
  }
  const auto none = refine(icosphere(2), SphereMesh());
  ASSERT_TRUE(none);
  EXPECT_TRUE(none->spheres.empty());
}

TEST(Refine, RefusesWhatNamesNoSphere) {
  const SphereMesh start{.spheres = {{Vector3d::Zero(), 1}}, .edges = {{SphereId(0), SphereId(1)}}};
  EXPECT_FALSE(refine(icosphere(2), start));
  EXPECT_FALSE(refine(icosphere(2), {.spheres = {{Vector3d::Zero(), -1}}}));
  EXPECT_FALSE(refine(icosphere(2), {.spheres = {{Vector3d::Zero(), 1}}}, {.pinned = {SphereId(1)}}));
}

TEST(Refine, StopsOnRequest) {
  std::stop_source source;
  source.request_stop();
  const auto fitted = refine(torus(1, 0.3), {.spheres = {{Vector3d::Zero(), 1}}}, {}, {.stop = source.get_token()});
  ASSERT_FALSE(fitted);
  EXPECT_EQ(fitted.error().kind, ErrorKind::Cancelled);
}

TEST(Refine, KeepsAnInnerFitWithinTheMesh) {
  const Mesh mesh = torus(1, 0.3);
  const auto fitted = refine(mesh, level_of(mesh, 12), {.mode = FitMode::Inner});
  ASSERT_TRUE(fitted);
  const double diagonal = bounding_box_diagonal(mesh);
  EXPECT_LE(containment(mesh, *fitted).crossed, 1e-3 * diagonal);
  const SphereMeshTree tree(*fitted);
  for (const Vector3d& p : mesh.positions) EXPECT_GT(tree.signed_distance(p), -1e-3 * diagonal);
  const MeshTree inside(mesh);
  for (const Sphere& s : fitted->spheres) EXPECT_LT(inside.signed_distance(s.centre), 1e-9 * diagonal);
}

TEST(Refine, RefusesAnInnerFitOfAnOpenMesh) {
  const auto fitted = refine(cylinder(1, 2, 30, 4), {.spheres = {{Vector3d::UnitZ(), 1}}}, {.mode = FitMode::Inner});
  ASSERT_FALSE(fitted);
  EXPECT_EQ(fitted.error().message, "refine: an inner fit needs a closed mesh; 60 edges have one face only");
}

TEST(Refine, PutsAnOuterFitAroundTheMesh) {
  const Mesh mesh = torus(1, 0.3);
  const auto fitted = refine(mesh, level_of(mesh, 12), {.mode = FitMode::Outer});
  ASSERT_TRUE(fitted);
  EXPECT_EQ(containment(mesh, *fitted).uncovered, 0);
  const SphereMeshTree tree(*fitted);
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    for (const Vector3d& w : {Vector3d(1, 0, 0), Vector3d(0.5, 0.5, 0), Vector3d(0.2, 0.3, 0.5)}) {
      const FaceId face(f);
      EXPECT_LE(
          tree.signed_distance(w[0] * mesh.corner(face, 0) + w[1] * mesh.corner(face, 1) + w[2] * mesh.corner(face, 2)),
          0);
    }
}

TEST(Containment, BoundsHowTwoBallsLie) {
  const Mesh mesh = icosphere(4);
  const Containment larger = containment(mesh, {.spheres = {{Vector3d::Zero(), 1.5}}});
  EXPECT_EQ(larger.uncovered, 0);
  EXPECT_NEAR(larger.crossed, 0.5, 5e-3);
  const Containment smaller = containment(mesh, {.spheres = {{Vector3d::Zero(), 0.5}}});
  EXPECT_NEAR(smaller.uncovered, 0.5, 5e-3);
  EXPECT_EQ(smaller.crossed, 0);
}

TEST(NearestSpheres, GiveEveryVertexToTheSphereItTouches) {
  const Mesh mesh = together(icosphere(2), moved(icosphere(2), Vector3d(4, 0, 0)));
  const auto spheres = nearest_spheres(mesh, {.spheres = {{Vector3d::Zero(), 1}, {Vector3d(4, 0, 0), 1}}});
  ASSERT_EQ(spheres.size(), mesh.positions.size());
  for (std::size_t k = 0; k < spheres.size(); ++k) EXPECT_EQ(spheres[k].index(), mesh.positions[k].x() > 2 ? 1U : 0U);
}

TEST(Refine, BeatsThePublishedFitsOfTheElephant) {
  const std::filesystem::path path = "../shared/data/meshes/elephant_24955.off";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const auto mesh = read_mesh(path);
  ASSERT_TRUE(mesh);
  const auto fitted = refine(*mesh, level_of(*mesh, 45));
  ASSERT_TRUE(fitted);
  EXPECT_EQ(fitted->spheres.size(), 45U);
  const auto errors = measure(*mesh, *fitted, {.samples = 50'000});
  ASSERT_TRUE(errors);
  EXPECT_LT(errors->hausdorff, 2.2);
  EXPECT_LT(errors->mean_input_to_approximation, 0.30);
  EXPECT_LT(errors->mean_approximation_to_input, 0.30);
}

}  // namespace
}  // namespace armature::sdk
