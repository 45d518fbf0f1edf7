#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <stop_token>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>
#include <armature/sdk/decimation/similar_decimation.h>
#include <armature/sdk/distance/measure.h>
#include <armature/sdk/hierarchy/hierarchy_file.h>
#include <armature/sdk/hierarchy/level_cursor.h>
#include <armature/sdk/io/read_mesh.h>
#include <gtest/gtest.h>

#include "tests/sdk/hierarchy/shapes.h"
#include "tests/sdk/mesh/surfaces.h"

namespace armature::sdk {
namespace {

Hierarchy similar_of(const Mesh& mesh, const SimilarityOptions& similarity = {}, const HierarchyOptions& options = {}) {
  auto similar = build_similar_hierarchy(mesh, options, similarity);
  EXPECT_TRUE(similar.has_value()) << (similar ? "" : similar.error().message);
  return similar ? std::move(similar->build.hierarchy) : Hierarchy();
}

Mesh bent() {
  return surfaces::together(surfaces::torus(2, 0.7, 40, 16, 0.3),
                            surfaces::moved(surfaces::torus(2, 0.7, 40, 16, 0.3), {6, 1, 0}));
}

constexpr std::array kAll = {RegionDescriptor::GlsHistograms, RegionDescriptor::GlsMean, RegionDescriptor::Quadric,
                             RegionDescriptor::ScaledGlsHistograms, RegionDescriptor::MergedGls};

TEST(SimilarDecimation, OfThresholdZeroIsThePlainHierarchyBitByBit) {
  for (const Mesh& mesh : {bent(), ball(3), soup(60)}) {
    const auto plain = build_hierarchy(mesh);
    ASSERT_TRUE(plain);
    const std::string bytes = encode_hierarchy(plain->hierarchy);
    for (const auto descriptor : kAll) {
      EXPECT_EQ(encode_hierarchy(similar_of(mesh, {.descriptor = descriptor, .threshold = 0})), bytes);
      const auto made = region_descriptor(mesh, {.descriptor = descriptor});
      ASSERT_TRUE(made);
      const auto similar = build_similar_hierarchy(mesh, **made, {}, {.descriptor = descriptor, .threshold = 0});
      ASSERT_TRUE(similar);
      EXPECT_EQ(encode_hierarchy(similar->build.hierarchy), bytes);
    }
  }
}

TEST(SimilarDecimation, HasFewerStepsThanCollapses) {
  for (const auto descriptor : kAll) {
    const Hierarchy h = similar_of(bent(), {.descriptor = descriptor, .threshold = 0.3});
    EXPECT_EQ(h.min_spheres(), 1U);
    EXPECT_LT(2 * h.step_count(), h.collapse_count());
    EXPECT_EQ(h.spheres_after(0), h.leaf_count());
    EXPECT_EQ(h.spheres_after(h.step_count()), 1U);
  }
  EXPECT_LT(similar_of(bent(), {.adaptive = true}).step_count(), bent().positions.size() - 1);
}

TEST(SimilarDecimation, CollapsesOfAStepAreIndependent) {
  // No collapse of a step joins what another of the same step made.
  const Hierarchy h = similar_of(bent());
  for (std::size_t step = 1; step <= h.step_count(); ++step) {
    const std::size_t first = 2 * h.leaf_count() - h.spheres_after(step - 1);
    const std::size_t last = 2 * h.leaf_count() - h.spheres_after(step);
    for (std::size_t node = first; node < last; ++node)
      for (const NodeId child : h.children(NodeId(node))) EXPECT_LT(child.index(), first);
  }
}

/// The share of levels at ends of steps at which two equal halves of the vertices have the same number of spheres.
double evenness(const Hierarchy& h, std::size_t most_spheres) {
  const std::size_t each = h.leaf_count() / 2;
  std::size_t even = 0;
  std::size_t levels = 0;
  for (std::size_t step = 1; step <= h.step_count() && h.spheres_after(step) > 2; ++step) {
    if (h.spheres_after(step) > most_spheres) continue;
    std::array<std::size_t, 2> count{};
    for (const NodeId node : h.nodes_of_level(h.spheres_after(step))) ++count[h.vertices(node)[0].index() / each];
    ++levels;
    even += count[0] == count[1] ? 1U : 0U;
  }
  return static_cast<double>(even) / static_cast<double>(levels);
}

/// A torus and another that is turned, and mirrored if `sign` is -1, beside it.
Mesh twins(double sign) {
  const Mesh one = surfaces::torus(2, 0.7, 40, 16, 0.3);
  Mesh other = sign < 0 ? surfaces::inside_out(one) : one;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (auto& p : other.positions) p = turn * Eigen::Vector3d(sign * p.x(), p.y(), p.z()) + Eigen::Vector3d(6, 1, 0);
  return surfaces::together(one, other);
}

TEST(SimilarDecimation, SimplifiesTwinsInStep) {
  for (const Mesh& mesh : {bent(), twins(1), twins(-1)}) {
    for (const std::size_t most : {std::size_t{400}, mesh.positions.size()}) {
      EXPECT_GE(evenness(similar_of(mesh), most), 0.9);
      EXPECT_LT(evenness(similar_of(mesh, {.threshold = 0}), most), 0.5);
    }
  }
}

TEST(SimilarDecimation, KeepsNoisyAndRemeshedCopiesEven) {
  const Mesh one = surfaces::torus(2, 0.7, 40, 16, 0.3);
  std::mt19937 random(1);
  Mesh shaken = one;
  for (auto& p : shaken.positions)
    for (int axis = 0; axis < 3; ++axis) p[axis] += 0.01 * (static_cast<double>(random()) / 0xFFFF'FFFFU - 0.5);
  const auto fewer = decimate_mesh(one, {.vertices = 3 * one.positions.size() / 4});
  ASSERT_TRUE(fewer);
  for (const Mesh& other : {shaken, fewer->mesh}) {
    const Mesh mesh = surfaces::together(one, surfaces::moved(other, {6, 1, 0}));
    const auto share = [&](const Hierarchy& h) {
      std::size_t even = 0;
      std::size_t levels = 0;
      for (std::size_t step = 1; step <= h.step_count() && h.spheres_after(step) > 2; ++step, ++levels) {
        std::array<std::size_t, 2> count{};
        for (const NodeId node : h.nodes_of_level(h.spheres_after(step)))
          ++count[h.vertices(node)[0].index() < one.positions.size() ? 0 : 1];
        even += count[0] == count[1] ? 1U : 0U;
      }
      return static_cast<double>(even) / static_cast<double>(levels);
    };
    EXPECT_GE(share(similar_of(mesh)), 0.9);
    EXPECT_LT(share(similar_of(mesh, {.threshold = 0})), 0.5);
  }
}

TEST(SimilarDecimation, KeepsTheTopologyOfNoisyCopies) {
  // What waits for one of each other copy may have to be left alone by the time that they have come.
  std::mt19937 random(1);
  Mesh copies;
  for (int k = 0; k < 6; ++k) {
    Mesh one = surfaces::torus(2, 0.7, 24, 10, 0.3);
    for (auto& p : one.positions)
      for (int axis = 0; axis < 3; ++axis) p[axis] += 0.05 * (static_cast<double>(random()) / 0xFFFF'FFFFU - 0.5);
    copies = surfaces::together(copies, surfaces::moved(one, {6.0 * k, 0, 0}));
  }
  const Hierarchy h = similar_of(copies, {}, {.keep_topology = true});
  for (const std::size_t spheres : {std::size_t{600}, std::size_t{200}, h.min_spheres()}) {
    const auto level = h.level(h.spheres_after(h.steps_to(spheres)));
    ASSERT_TRUE(level);
    EXPECT_TRUE(level->edges.empty()) << spheres;
    EXPECT_EQ(level->triangles.size(), 2 * level->spheres.size()) << spheres;  // of tori
  }
  EXPECT_LT(h.min_spheres(), 120U);
}

TEST(SimilarDecimation, EndsWhereSomeOfWhatCorrespondsTurnsTrianglesOver) {
  // Seven noisy copies of a strip, some of their triangles missing.
  const auto strips = read_mesh("tests/data/meshes/torn_strips.off");
  ASSERT_TRUE(strips) << strips.error().message;
  for (const RegionDescriptor descriptor : kAll) {
    const auto coarse = decimate_similar_mesh(*strips, {.vertices = 1}, {.descriptor = descriptor});
    ASSERT_TRUE(coarse) << coarse.error().message;
    EXPECT_TRUE(build_similar_hierarchy(*strips, {}, {.descriptor = descriptor, .adaptive = true}));
  }
}

TEST(SimilarDecimation, TakesAsManyStepsInAnyUnit) {
  const Mesh mesh = bent();
  for (const RegionDescriptor descriptor : {RegionDescriptor::GlsHistograms, RegionDescriptor::Quadric}) {
    const Hierarchy h = similar_of(mesh, {.descriptor = descriptor});
    for (const int power : {-900, -100, 100, 900}) {
      Mesh other = mesh;
      for (auto& p : other.positions)
        p = Eigen::Vector3d(std::ldexp(p.x(), power), std::ldexp(p.y(), power), std::ldexp(p.z(), power));
      EXPECT_EQ(similar_of(other, {.descriptor = descriptor}).parts().steps, h.parts().steps) << power;
    }
  }
}

TEST(SimilarDecimation, GivesTurnedCopiesTheSameSpheres) {
  // Radii are bounded by extents along fixed directions, of which turned copies have others.
  const Mesh one = surfaces::torus(2, 0.7, 40, 16, 0.3);
  const Hierarchy h = similar_of(twins(1));
  for (const std::size_t spheres : {std::size_t{200}, std::size_t{60}}) {
    const std::size_t step = h.steps_to(spheres);
    std::array<std::vector<double>, 2> radii;
    for (const NodeId node : h.nodes_of_level(h.spheres_after(step)))
      radii[h.vertices(node)[0].index() < one.positions.size() ? 0 : 1].push_back(h.sphere(node).radius);
    for (auto& list : radii) std::ranges::sort(list);
    ASSERT_EQ(radii[0].size(), radii[1].size());
    for (std::size_t k = 0; k < radii[0].size(); ++k) EXPECT_NEAR(radii[0][k], radii[1][k], 1e-6);
  }
}

TEST(SimilarDecimation, SimplifiesHundredsOfCopiesInStep) {
  const Mesh one = surfaces::torus(2, 0.7, 10, 6, 0.3);
  Mesh many;
  constexpr std::size_t kCopies = 300;
  for (std::size_t k = 0; k < kCopies; ++k)
    many = surfaces::together(
        many, surfaces::moved(one, {6.0 * static_cast<double>(k % 20), 6.0 * static_cast<double>(k / 20), 0}));
  const Hierarchy h = similar_of(many, {.descriptor = RegionDescriptor::Quadric});
  std::size_t even = 0;
  std::size_t levels = 0;
  for (std::size_t step = 1; step <= h.step_count() && h.spheres_after(step) >= kCopies; ++step, ++levels) {
    std::array<std::size_t, kCopies> count{};
    for (const NodeId node : h.nodes_of_level(h.spheres_after(step)))
      ++count[h.vertices(node)[0].index() / one.positions.size()];
    even += std::ranges::count(count, count[0]) == kCopies ? 1U : 0U;
  }
  EXPECT_LE(levels, one.positions.size());
  EXPECT_GE(static_cast<double>(even), 0.9 * static_cast<double>(levels));
}

TEST(SimilarDecimation, StopsWhereAsked) {
  std::stop_source stop;
  const Task task{.stop = stop.get_token(), .progress = [&](std::string_view stage, double) {
                    if (stage == "finding counterparts") stop.request_stop();
                  }};
  const auto similar = build_similar_hierarchy(bent(), {}, {}, task);
  ASSERT_FALSE(similar);
  EXPECT_EQ(similar.error().message, cancelled().value().message);
}

TEST(SimilarDecimation, KeepsAMirroredShapeEven) {
  // A ball with bumps anywhere on one half and their mirror images on the other.
  Mesh mesh = ball(4);
  for (Eigen::Vector3d& p : mesh.positions) {
    const Eigen::Vector3d q(std::abs(p.x()), p.y(), p.z());
    double reach = 1 + 0.2 * q.y();
    for (int k = 0; k < 8; ++k) {
      const Eigen::Vector3d bump(std::abs(std::sin(3.0 * k + 1)), std::sin(5.0 * k), std::cos(7.0 * k));
      reach += (0.2 + 0.1 * k) * std::exp(-(q - bump.normalized()).squaredNorm() / 0.05);
    }
    p *= reach;
  }
  const auto share = [&](const Hierarchy& h) {
    std::size_t even = 0;
    std::size_t levels = 0;
    for (std::size_t step = 1; step <= h.step_count() && h.spheres_after(step) > 8; ++step) {
      if (h.spheres_after(step) > 200) continue;
      std::array<std::size_t, 2> count{};
      for (const NodeId node : h.nodes_of_level(h.spheres_after(step))) {
        std::array<std::size_t, 2> vertices{};
        for (const VertexId v : h.vertices(node)) {
          const double x = mesh.position(v).x();
          if (std::abs(x) > 1e-9) ++vertices[x > 0 ? 0 : 1];
        }
        if (vertices[0] != vertices[1]) ++count[vertices[0] > vertices[1] ? 0 : 1];
      }
      ++levels;
      even += count[0] == count[1] ? 1U : 0U;
    }
    return static_cast<double>(even) / static_cast<double>(levels);
  };
  EXPECT_EQ(share(similar_of(mesh)), 1);
  EXPECT_LT(share(similar_of(mesh, {.threshold = 0})), 0.5);
}

TEST(SimilarDecimation, IsNavigableAndKeepsItsStepsInAFile) {
  const Hierarchy h = similar_of(bent());
  const auto again = parse_hierarchy(encode_hierarchy(h), "bytes");
  ASSERT_TRUE(again);
  EXPECT_EQ(again->parts().steps, h.parts().steps);
  LevelCursor cursor(*again, h.leaf_count());
  std::size_t steps = 0;
  while (cursor.coarsen_step()) EXPECT_EQ(cursor.size(), h.spheres_after(++steps));
  EXPECT_EQ(steps, h.step_count());
  while (cursor.refine_step()) EXPECT_EQ(cursor.size(), h.spheres_after(--steps));
  EXPECT_EQ(steps, 0U);
  EXPECT_EQ(h.steps_to(h.leaf_count()), 0U);
  EXPECT_EQ(h.steps_to(h.leaf_count() - 1), 1U);
  EXPECT_EQ(h.steps_to(1), h.step_count());
}

TEST(SimilarDecimation, WorksOnMeshesByTheQuadricErrorMetric) {
  const Mesh mesh = bent();
  const auto coarse = decimate_similar_mesh(mesh, {.vertices = 100});
  ASSERT_TRUE(coarse);
  EXPECT_EQ(coarse->decimated.mesh.positions.size(), 100U);
  EXPECT_LT(2 * coarse->steps, mesh.positions.size() - 100);
  const auto plain = decimate_mesh(mesh, {.vertices = 100});
  const auto same = decimate_similar_mesh(mesh, {.vertices = 100}, {.threshold = 0});
  ASSERT_TRUE(plain && same);
  EXPECT_EQ(same->decimated.mesh.positions, plain->mesh.positions);
  EXPECT_EQ(same->decimated.mesh.triangles, plain->mesh.triangles);
}

TEST(SimilarDecimation, NeverJoinsPinnedSpheresThatCorrespond) {
  // An ellipsoid with three planes of symmetry; each pinned vertex has seven mirror images, pinned as well.
  Mesh mesh = ball(2);
  for (Eigen::Vector3d& p : mesh.positions) p = p.cwiseProduct(Eigen::Vector3d(1.7, 1.3, 1));
  HierarchyOptions options;
  const Eigen::Vector3d one = mesh.positions[static_cast<std::size_t>(
      std::ranges::max_element(mesh.positions, {}, [](const auto& p) { return p.cwiseAbs().minCoeff(); }) -
      mesh.positions.begin())];
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    if ((mesh.positions[v].cwiseAbs() - one.cwiseAbs()).norm() < 1e-9) options.pinned.push_back({VertexId(v)});
  ASSERT_EQ(options.pinned.size(), 8U);
  const auto similar = build_similar_hierarchy(mesh, options);
  ASSERT_TRUE(similar);
  EXPECT_EQ(similar->build.hierarchy.min_spheres(), 8U);
}

TEST(SimilarDecimation, TakesAnyMesh) {
  Mesh loose = bent();
  loose.positions.emplace_back(1, 2, 3);
  Mesh points;
  points.positions = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}};
  Mesh one;
  one.positions = {{1, 1, 1}};
  for (const Mesh& mesh : {loose, points, one, soup(40), ball(0)})
    for (const auto descriptor : kAll) EXPECT_EQ(similar_of(mesh, {.descriptor = descriptor}).min_spheres(), 1U);
  EXPECT_FALSE(build_similar_hierarchy(Mesh{}));
  EXPECT_FALSE(build_similar_hierarchy(ball(1), {}, {.threshold = -1}));
  EXPECT_FALSE(build_similar_hierarchy(ball(1), {}, {.cost_ratio = 0.5}));
}

/// Points of two tubes bent to rings that lie on one another once one is moved.
PointSet bent_points() {
  PointSet points = sample_points(surfaces::torus(2, 0.7, 40, 16, 0.3), 1500);
  for (std::size_t i = 0, count = points.positions.size(); i < count; ++i) {
    points.positions.emplace_back(points.positions[i] + Eigen::Vector3d(6, 1, 0));
    points.normals.push_back(points.normals[i]);
  }
  return points;
}

TEST(SimilarDecimation, OfPointsOfThresholdZeroIsThePlainHierarchyBitByBit) {
  const auto plain = build_hierarchy(bent_points());
  ASSERT_TRUE(plain);
  for (const auto descriptor : kAll) {
    const auto similar = build_similar_hierarchy(bent_points(), {}, {.descriptor = descriptor, .threshold = 0});
    ASSERT_TRUE(similar);
    EXPECT_EQ(encode_hierarchy(similar->build.hierarchy), encode_hierarchy(plain->hierarchy));
  }
}

TEST(SimilarDecimation, OfPointsKeepsCopiesInStep) {
  const PointSet points = bent_points();
  for (const auto descriptor : kAll) {
    const auto similar = build_similar_hierarchy(points, {}, {.descriptor = descriptor, .threshold = 0.3});
    ASSERT_TRUE(similar);
    const Hierarchy& h = similar->build.hierarchy;
    EXPECT_EQ(h.min_spheres(), 1U);
    EXPECT_LT(2 * h.step_count(), h.collapse_count());
    std::size_t levels = 0;
    std::size_t even = 0;
    for (std::size_t k = 1; k <= h.step_count() && h.spheres_after(k) > 2; ++k) {
      if (h.spheres_after(k) > 200) continue;
      std::size_t first = 0;
      for (const NodeId node : h.nodes_of_level(h.spheres_after(k)))
        first += h.vertices(node).front().index() < points.positions.size() / 2 ? 1U : 0U;
      ++levels;
      even += 2 * first == h.spheres_after(k) ? 1U : 0U;
    }
    EXPECT_GE(static_cast<double>(even), 0.9 * static_cast<double>(levels));
  }
}

TEST(SimilarDecimation, OfPointsIsRefusedWhereTheyAreWrong) {
  PointSet points = bent_points();
  points.normals.pop_back();
  EXPECT_FALSE(build_similar_hierarchy(points));
  EXPECT_FALSE(build_similar_hierarchy(PointSet{}));
  EXPECT_FALSE(region_descriptor(points, {.descriptor = RegionDescriptor::Quadric}));
}

}  // namespace
}  // namespace armature::sdk
