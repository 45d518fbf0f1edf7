#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include <armature/sdk/descriptors/descriptors.h>
#include <gtest/gtest.h>

#include "tests/sdk/mesh/surfaces.h"

namespace armature::sdk {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// Two tori of different girth beside a ball, and every descriptor of them.
class Descriptors : public testing::Test {
 protected:
  Descriptors() {
    mesh = surfaces::together(surfaces::torus(2, 0.7, 40, 16, 0.2),
                              surfaces::moved(surfaces::torus(2, 0.7, 40, 16, 0.2), {0, 0, 4}));
    first_of_ball = mesh.positions.size();
    mesh = surfaces::together(mesh, surfaces::moved(surfaces::icosphere(3), {6, 0, 0}));
    auto gls = GrowingLeastSquares::build(point_set_of(mesh));
    EXPECT_TRUE(gls.has_value());
    for (const auto how :
         {GlsAggregation::Mean, GlsAggregation::Histograms, GlsAggregation::ScaledHistograms, GlsAggregation::Merged}) {
      auto made = gls_descriptor(*gls, how);
      EXPECT_TRUE(made.has_value());
      all.push_back(std::move(*made));
    }
    all.push_back(quadric_descriptor(mesh));
    const Laplacian l = laplacian(mesh, Adjacency(mesh));
    const auto s = spectrum(mesh, l, {.count = 40});
    EXPECT_TRUE(s.has_value());
    for (const auto& signature : {heat_kernel_signature, wave_kernel_signature, scale_invariant_heat_kernel_signature})
      all.push_back(signature(*s, l));
    surface = std::make_unique<Surface>(mesh);
    auto found = PatchContexts::build(*surface, 0.8);
    EXPECT_TRUE(found.has_value());
    contexts = std::make_unique<PatchContexts>(std::move(*found));
    auto of_patches = patch_shape_context(*surface, *contexts);
    EXPECT_TRUE(of_patches.has_value());
    all.push_back(std::move(*of_patches));
    const auto index = ComponentIndex::build(mesh, surface->adjacency);
    EXPECT_TRUE(index.has_value());
    all.push_back(approximate_shape_context(mesh, *index));
  }

  Mesh mesh;
  std::size_t first_of_ball = 0;
  std::unique_ptr<Surface> surface;
  std::unique_ptr<PatchContexts> contexts;
  std::vector<std::unique_ptr<Descriptor>> all;
};

/// The descriptor of a region, its vertices taken together in an order.
std::vector<float> region(const Descriptor& d, const std::vector<std::size_t>& vertices) {
  std::vector<float> sum(d.width());
  std::vector<float> one(d.width());
  d.describe(VertexId(vertices.front()), sum);
  for (std::size_t k = 1; k < vertices.size(); ++k) {
    d.describe(VertexId(vertices[k]), one);
    d.aggregate(sum, one);
  }
  return sum;
}

TEST_F(Descriptors, AggregateInAnyOrderAndCoverTheArea) {
  const std::vector<std::size_t> there = {3, 17, 99, 640, 801};
  const std::vector<std::size_t> back(there.rbegin(), there.rend());
  for (const auto& d : all) {
    ASSERT_EQ(d->size(), mesh.positions.size());
    const auto a = region(*d, there);
    const auto b = region(*d, back);
    double area = 0;
    for (const std::size_t v : there) area += d->area(region(*d, {v}));
    EXPECT_NEAR(d->area(a), area, 1e-5 * area);
    EXPECT_NEAR(d->dissimilarity(a, b, kNoLimit), 0, 1e-4);
    EXPECT_EQ(d->dissimilarity(a, a, kNoLimit), 0);
  }
}

TEST_F(Descriptors, AddAVertexAsTheyAggregateItsDescriptor) {
  for (const auto& d : all) {
    std::vector<float> sum(d->width());
    d->describe(VertexId(3), sum);
    for (const std::size_t v : {17U, 99U, 640U, 801U}) d->add(sum, VertexId(v));
    const auto aggregated = region(*d, {3, 17, 99, 640, 801});
    for (std::size_t k = 0; k < sum.size(); ++k)
      EXPECT_NEAR(sum[k], aggregated[k], 1e-6F * (1 + std::abs(aggregated[k])));
    EXPECT_EQ(d->area(VertexId(99)), d->area(region(*d, {99})));
  }
}

TEST_F(Descriptors, AreSymmetricAndTellATorusFromABall) {
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Descriptor& d = *all[k];
    std::vector<std::size_t> torus(640), twin(640), ball(mesh.positions.size() - first_of_ball);
    std::iota(torus.begin(), torus.end(), std::size_t{0});
    std::iota(twin.begin(), twin.end(), std::size_t{640});
    std::iota(ball.begin(), ball.end(), first_of_ball);
    const auto a = region(d, torus);
    const auto b = region(d, twin);
    const auto c = region(d, ball);
    EXPECT_DOUBLE_EQ(d.dissimilarity(a, c, kNoLimit), d.dissimilarity(c, a, kNoLimit)) << k;
    EXPECT_GT(d.dissimilarity(a, c, kNoLimit), 3 * d.dissimilarity(a, b, kNoLimit)) << k;
  }
}

TEST_F(Descriptors, KeepTheirWordOnLimits) {
  for (const auto& d : all)
    for (const std::size_t v : {5U, 700U, 1300U, 1500U}) {
      const auto a = region(*d, {v, v + 1, v + 2});
      for (const std::size_t w : {20U, 900U, 1400U}) {
        const auto b = region(*d, {w, w + 1});
        const double whole = d->dissimilarity(a, b, kNoLimit);
        for (const double limit : {0.01, 0.1, 0.3, 0.7}) {
          const double found = d->dissimilarity(a, b, limit);
          if (whole < limit)
            EXPECT_NEAR(found, whole, 1e-6);
          else
            EXPECT_GE(found, limit * (1 - 1e-6));
        }
      }
    }
}

TEST_F(Descriptors, MakeSimilarityMaps) {
  for (const auto& d : all) {
    const std::vector<VertexId> reference = {VertexId(first_of_ball + 3)};
    const auto unlike = dissimilarities(*d, reference);
    ASSERT_TRUE(unlike);
    const auto map = similarity_map(*unlike, 0.2);
    EXPECT_FLOAT_EQ(map[first_of_ball + 3], 1);
    for (const float s : map) {
      EXPECT_GE(s, 0);
      EXPECT_LE(s, 1);
    }
    EXPECT_FALSE(dissimilarities(*d, {}));
    const std::vector<VertexId> nowhere = {VertexId(1U << 20U)};
    EXPECT_FALSE(dissimilarities(*d, nowhere));
  }
}

TEST(SimilarityMap, IsZeroWhereNothingIsKnown) {
  const std::vector<float> unlike = {0, 1, std::numeric_limits<float>::infinity(),
                                     std::numeric_limits<float>::quiet_NaN()};
  const auto map = similarity_map(unlike, 1);
  EXPECT_FLOAT_EQ(map[0], 1);
  EXPECT_NEAR(map[1], std::exp(-0.5), 1e-6);
  EXPECT_EQ(map[2], 0);
  EXPECT_EQ(map[3], 0);
}

}  // namespace
}  // namespace armature::sdk
