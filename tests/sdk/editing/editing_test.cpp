#include <cmath>
#include <limits>
#include <numeric>

#include <Eigen/Geometry>
#include <armature/sdk/editing/region_edits.h>
#include <armature/sdk/editing/vertex_edits.h>
#include <armature/sdk/expansion/component_index.h>
#include <armature/sdk/mesh/measures.h>
#include <gtest/gtest.h>

#include "tests/sdk/mesh/surfaces.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

Laplacian laplacian_of(const Mesh& mesh) {
  return laplacian(mesh, Adjacency(mesh));
}

TEST(Transfer, IsZeroBelowAndOneAboveAndRisesBetween) {
  const Transfer transfer{.from = 0.2, .to = 0.6};
  EXPECT_EQ(transfer(0.2), 0);
  EXPECT_EQ(transfer(0.6), 1);
  EXPECT_NEAR(transfer(0.4), 0.5, 1e-12);
  EXPECT_LT(transfer(0.3), transfer(0.31));
}

TEST(VertexEdits, DisplaceAlongNormalsByWeight) {
  const Mesh ball = surfaces::icosphere(3);
  std::vector<double> weights(ball.positions.size(), 0.5);
  weights[0] = 0;
  const auto grown = displaced(ball, weights, 0.2);
  ASSERT_TRUE(grown);
  EXPECT_EQ(grown->positions[0], ball.positions[0]);
  for (std::size_t v = 1; v < weights.size(); ++v) EXPECT_NEAR(grown->positions[v].norm(), 1.1, 1e-3);
  EXPECT_FALSE(displaced(ball, std::vector<double>(3), 0.2));
}

TEST(VertexEdits, SmoothNoiseWhereTheWeightIsAndHoldTheRest) {
  const Mesh noisy = surfaces::over({40, 40, false, false, 0}, [](double i, double j) {
    return Vector3d(i, j, 0.01 * std::sin(90 * i) * std::sin(90 * j));
  });
  std::vector<double> weights(noisy.positions.size());
  for (std::size_t v = 0; v < weights.size(); ++v) weights[v] = noisy.positions[v].x() < 0.5 ? 1 : 0;
  const auto flat = smoothed(noisy, laplacian_of(noisy), weights, 0.1);
  const auto sharp = sharpened(noisy, laplacian_of(noisy), weights, 0.1, 0.5);
  ASSERT_TRUE(flat && sharp);
  double before = 0, after = 0, more = 0;
  for (std::size_t v = 0; v < weights.size(); ++v) {
    if (weights[v] == 0) {
      EXPECT_EQ(flat->positions[v], noisy.positions[v]);
      continue;
    }
    const Vector3d& p = noisy.positions[v];
    if (p.x() > 0.35 || p.x() < 0.1 || p.y() < 0.1 || p.y() > 0.9) continue;
    before += std::abs(p.z());
    after += std::abs(flat->positions[v].z());
    more += std::abs(sharp->positions[v].z());
  }
  EXPECT_LT(after, 0.2 * before);
  EXPECT_GT(more, 1.3 * before);
}

TEST(VertexEdits, SmoothHalvesALargeBumpByItsLength) {
  // (1 + l^2 k^2) p' = p for a wave of number k: halved where l = 1 / k.
  const double k = 4 * 3.14159265358979;
  const Mesh wave = surfaces::over({120, 60, false, false, 0},
                                   [&](double i, double j) { return Vector3d(i, 0.5 * j, 0.001 * std::cos(k * i)); });
  const auto half = smoothed(wave, laplacian_of(wave), std::vector<double>(wave.positions.size(), 1.0), 1 / k);
  ASSERT_TRUE(half);
  double sum = 0, of = 0;
  for (std::size_t v = 0; v < wave.positions.size(); ++v) {
    if (std::abs(wave.positions[v].x() - 0.5) > 0.1) continue;
    sum += half->positions[v].z() * wave.positions[v].z();
    of += wave.positions[v].z() * wave.positions[v].z();
  }
  EXPECT_NEAR(sum / of, 0.5, 0.03);
}

TEST(VertexEdits, PaintMixesColoursByWeight) {
  const Mesh cube = surfaces::cube();
  std::vector<double> weights(8, 0.0);
  weights[2] = 1;
  const auto red = painted(cube, weights, {200, 0, 0});
  ASSERT_TRUE(red);
  EXPECT_EQ(red->vertex_colours[2], (Colour{200, 0, 0}));
  EXPECT_EQ(red->vertex_colours[1], (Colour{214, 214, 210}));
}

TEST(VertexEdits, PaintGoesNoFurtherThanItsColour) {
  const Mesh cube = surfaces::cube();
  const std::vector<double> weights = {3, -2, std::numeric_limits<double>::quiet_NaN(), 1, 0, 0, 0, 0};
  const auto red = painted(cube, weights, {200, 0, 0});
  ASSERT_TRUE(red);
  EXPECT_EQ(red->vertex_colours[0], red->vertex_colours[3]);
  EXPECT_EQ(red->vertex_colours[1], red->vertex_colours[4]);
  EXPECT_EQ(red->vertex_colours[2], red->vertex_colours[4]);
}

/// A lopsided blob.
Mesh blob() {
  Mesh mesh = surfaces::icosphere(4);
  for (Vector3d& p : mesh.positions) {
    const double bump = 0.5 * std::exp(-4 * (p - Vector3d(1, 0.2, 0.1).normalized()).squaredNorm()) +
                        0.3 * std::exp(-6 * (p - Vector3d(-0.2, 1, 0.5).normalized()).squaredNorm());
    p = (1 + bump) * Vector3d(1.3 * p.x(), p.y(), 0.8 * p.z());
  }
  return mesh;
}

/// Blobs: one, one turned and twice as large, and a mirror image; with the motions of the reference onto them.
struct Blobs {
  Mesh mesh = blob();
  std::vector<Eigen::Affine3d> to = {Eigen::Affine3d::Identity()};
  std::size_t each = mesh.positions.size();
  std::size_t faces = mesh.triangles.size();

  Blobs() {
    const Mesh first = mesh;
    Eigen::Affine3d turned =
        Eigen::Translation3d(7, 1, 0) * Eigen::AngleAxisd(1.1, Vector3d(1, 2, 3).normalized()) * Eigen::Scaling(2.0);
    Eigen::Affine3d mirrored = Eigen::Translation3d(-6, 0, 2) * Eigen::AngleAxisd(0.4, Vector3d(0, 1, 1).normalized()) *
                               Eigen::Scaling(Vector3d(-1, 1, 1));
    for (const auto& motion : {turned, mirrored}) {
      Mesh copy = first;
      for (Vector3d& p : copy.positions) p = motion * p;
      mesh = surfaces::together(mesh, motion.linear().determinant() < 0 ? surfaces::inside_out(copy) : copy);
      to.push_back(motion);
    }
  }
  [[nodiscard]] double diagonal() const { return bounding_box_diagonal(mesh); }
};

TEST(RegionEdits, ComeOutOnEveryComponentAsIfDoneThere) {
  const Blobs blobs;
  const Surface surface(blobs.mesh);
  const auto index = ComponentIndex::build(blobs.mesh, surface.adjacency);
  ASSERT_TRUE(index);
  const auto expansion = index->expand(FaceId(0));
  ASSERT_TRUE(expansion);
  ASSERT_EQ(expansion->size(), 2U);
  const Vector3d handle = blobs.mesh.positions[100];
  for (const RegionEdit& edit :
       {RegionEdit(DisplaceEdit{0.2}), RegionEdit(SmoothEdit{0.3}), RegionEdit(HandleEdit{handle, {0.5, 0.3, -0.4}})}) {
    const auto all = transported(surface, expansion->reference(), expansion->first(2), edit);
    ASSERT_TRUE(all) << all.error().message;
    double farthest = 0;
    for (std::size_t k = 1; k < 3; ++k)
      for (std::size_t v = 0; v < blobs.each; ++v) {
        // What is done to the reference is known; the others must be its image.
        const Vector3d truth = blobs.to[k] * all->positions[v];
        farthest = std::max(farthest, (all->positions[k * blobs.each + v] - truth).norm());
      }
    EXPECT_LT(farthest, 0.01 * bounding_box_diagonal(blob()));
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t v = k * blobs.each + 100;
      EXPECT_GT((all->positions[v] - blobs.mesh.positions[v]).norm(), 0.01);
    }
  }
}

/// A cap of the reference and the same caps elsewhere, with the true motions.
TEST(RegionEdits, FadeAtTheBoundaryAndLeaveTheRestAlone) {
  const Blobs blobs;
  const Surface surface(blobs.mesh);
  std::vector<FaceId> cap;
  std::vector<Match> matches(2);
  for (std::size_t f = 0; f < blobs.faces; ++f) {
    if (!(blobs.mesh.corner(FaceId(f), 0).x() > 0.8)) continue;
    cap.emplace_back(f);
    for (std::size_t k = 1; k < 3; ++k) matches[k - 1].faces.emplace_back(k * blobs.faces + f);
  }
  for (std::size_t k = 1; k < 3; ++k) {
    matches[k - 1].reference_from_match = blobs.to[k].inverse().matrix();
    matches[k - 1].mirrored = k == 2;
  }
  std::vector<bool> within(blobs.mesh.positions.size(), false);
  for (const auto& faces : {std::span<const FaceId>(cap), std::span<const FaceId>(matches[0].faces),
                            std::span<const FaceId>(matches[1].faces)})
    for (const FaceId f : faces)
      for (const VertexId v : blobs.mesh.triangle(f)) within[v.index()] = true;
  for (const RegionEdit& edit : {RegionEdit(DisplaceEdit{0.2}), RegionEdit(SmoothEdit{0.2}),
                                 RegionEdit(HandleEdit{{1.8, 0.2, 0.1}, {0.3, 0.2, 0}})}) {
    const auto all = transported(surface, cap, matches, edit);
    ASSERT_TRUE(all);
    double farthest = 0;
    for (std::size_t v = 0; v < blobs.mesh.positions.size(); ++v) {
      const double way = (all->positions[v] - blobs.mesh.positions[v]).norm();
      if (!within[v]) {
        EXPECT_EQ(way, 0);
      }
      const bool at_rim = std::ranges::any_of(surface.adjacency.neighbours(VertexId(v)),
                                              [&](VertexId u) { return !within[u.index()]; });
      if (at_rim) {
        EXPECT_LT(way, 1e-3);
      }
    }
    for (std::size_t k = 1; k < 3; ++k)
      for (std::size_t v = 0; v < blobs.each; ++v)
        farthest = std::max(farthest, (all->positions[k * blobs.each + v] - blobs.to[k] * all->positions[v]).norm());
    EXPECT_LT(farthest, 1e-3 * blobs.diagonal());
  }
}

TEST(RegionEdits, CopyAndMeanAgreeOnWhatIsEqualAndMeetInTheMiddle) {
  Blobs blobs;
  Mesh& mesh = blobs.mesh;
  std::vector<Match> matches(1);
  for (std::size_t f = 0; f < blobs.faces; ++f) matches[0].faces.emplace_back(blobs.faces + f);
  matches[0].reference_from_match = blobs.to[1].inverse().matrix();
  std::vector<FaceId> reference(blobs.faces);
  for (std::size_t f = 0; f < blobs.faces; ++f) reference[f] = FaceId(f);
  // The second, twice as large, is thicker by 0.1.
  const Mesh thin = mesh;
  const auto normals = vertex_normals(mesh);
  for (std::size_t v = blobs.each; v < 2 * blobs.each; ++v) mesh.positions[v] += 0.1 * normals[v];
  const Surface surface(mesh);
  const auto copied = transported(surface, reference, matches, CopyEdit{});
  const auto mean = made_alike(surface, reference, matches, 1);
  const auto apart = made_alike(surface, reference, matches, -1);
  ASSERT_TRUE(copied && mean && apart);
  for (std::size_t v = 0; v < blobs.each; ++v) {
    EXPECT_NEAR((copied->positions[v] - mesh.positions[v]).norm(), 0, 1e-12);
    EXPECT_NEAR((copied->positions[blobs.each + v] - thin.positions[blobs.each + v]).norm(), 0, 0.02);
    EXPECT_NEAR((mean->positions[v] - mesh.positions[v]).dot(normals[v]), 0.025, 0.005);
    EXPECT_NEAR((apart->positions[v] - mesh.positions[v]).dot(normals[v]), -0.025, 0.005);
  }
}

TEST(RegionEdits, TakeNoMatchesAndRefuseWhatIsNotThere) {
  const Blobs blobs;
  const Surface surface(blobs.mesh);
  const std::vector<FaceId> one = {FaceId(0)};
  EXPECT_TRUE(transported(surface, one, {}, DisplaceEdit{0.1}));
  EXPECT_FALSE(transported(surface, {}, {}, DisplaceEdit{0.1}));
  const std::vector<FaceId> nowhere = {FaceId(1U << 20U)};
  const auto refused = transported(surface, nowhere, {}, DisplaceEdit{0.1});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "reference: expected faces below 15360");
  std::vector<Match> flat(1);
  flat[0].faces = one;
  flat[0].reference_from_match.setZero();
  EXPECT_FALSE(transported(surface, one, flat, DisplaceEdit{0.1}));
  EXPECT_FALSE(transported(surface, one, {}, DisplaceEdit{0.1}, {.blend = 2}));
}

TEST(VertexEdits, OfPointsMoveAlongTheirNormalsAndColour) {
  const PointSet points{.positions = {{0, 0, 0}, {1, 0, 0}}, .normals = {{0, 0, 1}, {0, 1, 0}}};
  const std::vector<double> weights = {1, 0.5};
  const auto moved = displaced(points, weights, 2);
  ASSERT_TRUE(moved);
  EXPECT_EQ(moved->positions, (std::vector<Eigen::Vector3d>{{0, 0, 2}, {1, 1, 0}}));
  const auto coloured = painted(points, weights, {0, 0, 0});
  ASSERT_TRUE(coloured);
  EXPECT_EQ(coloured->colours, (std::vector<Colour>{{0, 0, 0}, {107, 107, 105}}));
  EXPECT_FALSE(displaced(points, std::vector<double>{1}, 2));
  EXPECT_FALSE(painted(PointSet{.positions = {{0, 0, 0}}}, std::vector<double>{1}, {0, 0, 0}));
}

}  // namespace
}  // namespace armature::sdk
