#include <algorithm>
#include <array>
#include <vector>

#include <armature/sdk/decimation/similar_decimation.h>
#include <armature/sdk/hierarchy/hierarchy_file.h>
#include <armature/sdk/hierarchy/level_cursor.h>
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
    for (const auto descriptor : kAll)
      EXPECT_EQ(encode_hierarchy(similar_of(mesh, {.descriptor = descriptor, .threshold = 0})), bytes);
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

TEST(SimilarDecimation, KeepsTwinsMoreAlikeThanThePlainOne) {
  const Mesh mesh = bent();
  EXPECT_GT(evenness(similar_of(mesh), 400), 1.2 * evenness(similar_of(mesh, {.threshold = 0}), 400));
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

}  // namespace
}  // namespace armature::sdk
