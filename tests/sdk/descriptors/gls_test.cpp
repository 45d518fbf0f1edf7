#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Geometry>
#include <armature/sdk/descriptors/descriptors.h>
#include <armature/sdk/descriptors/gls.h>
#include <armature/sdk/mesh/measures.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "sdk/descriptors/gls_fit.h"
#include "tests/sdk/mesh/surfaces.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

/// All points with whole coordinates on a sphere of radius 105 about a place, so that they lie on it exactly.
PointSet whole_ball(const Vector3d& middle) {
  constexpr int kRadius = 105;
  PointSet points;
  for (int x = -kRadius; x <= kRadius; ++x)
    for (int y = -kRadius; y <= kRadius; ++y) {
      const int z2 = kRadius * kRadius - x * x - y * y;
      const int z = static_cast<int>(std::lround(std::sqrt(std::max(z2, 0))));
      if (z2 < 0 || z * z != z2) continue;
      for (const int sign : {-1, 1}) {
        if (z == 0 && sign > 0) continue;
        const Vector3d p(x, y, sign * z);
        points.positions.push_back(middle + p);
        points.normals.push_back(p / kRadius);
      }
    }
  return points;
}

GrowingLeastSquares built(PointSet points, GlsOptions options = {}) {
  auto gls = GrowingLeastSquares::build(std::move(points), std::move(options));
  EXPECT_TRUE(gls.has_value()) << (gls ? "" : gls.error().message);
  return std::move(*gls);
}

/// The sums as they are written down.
Gls brute_force(const PointSet& points, const Vector3d& place, double t) {
  GlsSums sums;
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    const Vector3d p = points.positions[i] - place;
    const double d2 = p.squaredNorm();
    if (d2 > t * t) continue;
    const double w = std::pow(d2 / (t * t) - 1, 2) * (points.areas.empty() ? 1 : points.areas[i]);
    sums += {.weight = w, .p = w * p, .n = w * points.normals[i], .pn = w * p.dot(points.normals[i]), .pp = w * d2};
  }
  return gls_of(fit_sphere(sums));
}

TEST(Gls, FindsTheSphereExactlyAlsoFarAway) {
  for (const double away : {0.0, 1e6}) {
    const Vector3d middle = away * 364 * Vector3d(1, -1, 1).normalized().array().round().matrix();
    for (const double merged : {0.0, 1.0 / 6}) {
      const PointSet points = whole_ball(middle);
      const GrowingLeastSquares gls = built(points, {.scales = {30, 90, 180, 500}, .merged = merged});
      for (std::size_t scale = 0; scale < 4; ++scale) {
        const auto all = gls.at_points(scale);
        ASSERT_TRUE(all);
        for (std::size_t i = 0; i < points.positions.size(); ++i) {
          EXPECT_NEAR((*all)[i].kappa * 105, 1, 1e-10);
          EXPECT_NEAR((*all)[i].tau / 105, 0, 1e-10);
          EXPECT_NEAR((*all)[i].phi, 1, 1e-10);
          EXPECT_NEAR(((*all)[i].eta - points.normals[i]).norm(), 0, 1e-10);
        }
        // Off the sphere tau is the algebraic distance, (d^2 - r^2) / 2r.
        EXPECT_NEAR(gls.at(middle + Vector3d(0, 0, 110), scale).tau, (110.0 * 110 - 105.0 * 105) / 210, 1e-8);
      }
    }
  }
}

TEST(Gls, FindsThePlaneExactlyAlsoFarAway) {
  for (const double away : {0.0, 1e6}) {
    PointSet points;
    for (int i = 0; i < 40; ++i)
      for (int j = 0; j < 40; ++j) {
        points.positions.emplace_back(i + 64 * away, j - 64 * away, 64 * away - i);
        points.normals.push_back(Vector3d(1, 0, 1).normalized());
      }
    const GrowingLeastSquares gls = built(points);
    ASSERT_EQ(gls.scales().size(), 10U);
    for (std::size_t scale = 0; scale < 10; ++scale)
      for (const std::size_t i : {0U, 20U, 820U, 1599U}) {
        const Gls at = gls.at(points.positions[i], scale);
        EXPECT_NEAR(at.kappa, 0, 1e-10);
        EXPECT_NEAR(at.tau, 0, 1e-10);
        EXPECT_NEAR(at.phi, 1, 1e-10);
        EXPECT_NEAR((at.eta - points.normals[0]).norm(), 0, 1e-10);
      }
  }
}

TEST(Gls, AgreesWithBruteForceOnACylinderAndATorus) {
  for (const Mesh& mesh : {surfaces::cylinder(1, 6, 120, 120, 0.3), surfaces::torus(2, 0.7, 160, 60, 0.3)}) {
    const PointSet points = point_set_of(mesh);
    const std::vector<double> scales = {0.2, 0.5, 1.1, 2.5};
    const GrowingLeastSquares exact = built(points, {.scales = scales, .merged = 0});
    const GrowingLeastSquares merged = built(points, {.scales = scales});
    for (std::size_t scale = 0; scale < scales.size(); ++scale) {
      const double t = scales[scale];
      const auto all = merged.at_points(scale);
      ASSERT_TRUE(all);
      for (std::size_t i = 0; i < points.positions.size(); i += 97) {
        const Gls truth = brute_force(points, points.positions[i], t);
        const Gls same = exact.at(points.positions[i], scale);
        EXPECT_NEAR((same.tau - truth.tau) / t, 0, 1e-12);
        EXPECT_NEAR((same.kappa - truth.kappa) * t, 0, 1e-11);
        EXPECT_NEAR(same.phi, truth.phi, 1e-12);
        // Merged within a sixth of the scale: within 2 % of the curvature of a ball as large as the scale.
        EXPECT_NEAR(((*all)[i].tau - truth.tau) / t, 0, 0.02);
        EXPECT_NEAR(((*all)[i].kappa - truth.kappa) * t, 0, 0.02);
        EXPECT_NEAR((*all)[i].phi, truth.phi, 0.02);
      }
    }
  }
}

TEST(Gls, ConvergesUnderRefinement) {
  // Quadratically: on a torus of 4 n by 2 n vertices the error stays below 2 / n^2.
  const auto at = [](int n) {
    const Mesh mesh = surfaces::torus(2, 0.7, 4 * n, 2 * n);
    return built(point_set_of(mesh), {.scales = {0.6}, .merged = 0}).at({2.7, 0, 0}, 0);
  };
  const Gls truth = at(320);
  for (const int n : {10, 20, 40, 80}) EXPECT_LT(std::sqrt(gls_dissimilarity(at(n), truth, 0.6)), 2.0 / (n * n)) << n;
}

TEST(Gls, DerivativesAgreeWithDifferences) {
  const PointSet points = point_set_of(surfaces::torus(2, 0.7, 160, 60, 0.3));
  const Vector3d place(2.6, 0.3, 0.2);
  constexpr double kScale = 0.9, kStep = 1e-5;
  const GrowingLeastSquares gls = built(points, {.scales = {kScale, kScale + kStep, kScale - kStep}});
  const GlsDerivatives d = gls.derivatives_at(place, 0);
  const auto check = [&](Eigen::Index k, const Gls& more, const Gls& less) {
    EXPECT_NEAR(d.tau[k], (more.tau - less.tau) / (2 * kStep), 1e-6) << k;
    EXPECT_NEAR(d.kappa[k], (more.kappa - less.kappa) / (2 * kStep), 1e-6) << k;
    EXPECT_NEAR(d.phi[k], (more.phi - less.phi) / (2 * kStep), 1e-6) << k;
    EXPECT_NEAR((d.eta.col(k) - (more.eta - less.eta) / (2 * kStep)).norm(), 0, 1e-6) << k;
  };
  for (Eigen::Index k = 0; k < 3; ++k)
    check(k, gls.at(place + kStep * Vector3d::Unit(k), 0), gls.at(place - kStep * Vector3d::Unit(k), 0));
  const GrowingLeastSquares exact = built(points, {.scales = {kScale, kScale + kStep, kScale - kStep}, .merged = 0});
  const GlsDerivatives by_scale = exact.derivatives_at(place, 0);
  EXPECT_NEAR(by_scale.tau[3], (exact.at(place, 1).tau - exact.at(place, 2).tau) / (2 * kStep), 1e-6);
  EXPECT_NEAR(by_scale.kappa[3], (exact.at(place, 1).kappa - exact.at(place, 2).kappa) / (2 * kStep), 1e-6);
  EXPECT_NEAR(by_scale.phi[3], (exact.at(place, 1).phi - exact.at(place, 2).phi) / (2 * kStep), 1e-6);
}

TEST(Gls, IsTheSameAfterAMotionAndScalesWithTheModel) {
  const PointSet points = point_set_of(surfaces::torus(2, 0.7, 80, 30, 0.3));
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.7, Vector3d(1, 2, -1).normalized()));
  PointSet moved = points;
  for (Vector3d& p : moved.positions) p = 10 * (turn * p) + Vector3d(5, 6, 7);
  for (Vector3d& n : moved.normals) n = turn * n;
  for (double& a : moved.areas) a *= 100;
  const GrowingLeastSquares here = built(points, {.scales = {0.4, 1}, .merged = 0});
  const GrowingLeastSquares there = built(moved, {.scales = {4, 10}, .merged = 0});
  for (const std::size_t scale : {0U, 1U})
    for (std::size_t i = 0; i < points.positions.size(); i += 71) {
      const Gls a = here.at(points.positions[i], scale);
      const Gls b = there.at(moved.positions[i], scale);
      EXPECT_NEAR(b.tau, 10 * a.tau, 1e-9);
      EXPECT_NEAR(10 * b.kappa, a.kappa, 1e-9);
      EXPECT_NEAR(b.phi, a.phi, 1e-9);
    }
}

TEST(Gls, IsTheSameOnOneThread) {
  const GrowingLeastSquares gls = built(point_set_of(surfaces::torus(2, 0.7, 80, 30, 0.3)));
  const auto many = gls.at_points(5);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto alone = gls.at_points(5);
  ASSERT_TRUE(many && alone);
  for (std::size_t i = 0; i < many->size(); ++i) {
    EXPECT_EQ((*many)[i].tau, (*alone)[i].tau);
    EXPECT_EQ((*many)[i].kappa, (*alone)[i].kappa);
  }
}

TEST(Gls, SaysWhatIsWrongWithPoints) {
  PointSet points = point_set_of(surfaces::cube());
  points.normals[3].x() = std::numeric_limits<double>::quiet_NaN();
  const auto refused = GrowingLeastSquares::build(points);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "point 3: expected a finite normal; a normal that is not known is 0 0 0");
  points.normals.pop_back();
  EXPECT_FALSE(GrowingLeastSquares::build(points));
  EXPECT_FALSE(GrowingLeastSquares::build(PointSet{}));
  EXPECT_FALSE(GrowingLeastSquares::build({.positions = {{1, 1, 1}}, .normals = {{0, 0, 1}}}));
  EXPECT_FALSE(GrowingLeastSquares::build(point_set_of(surfaces::cube()), {.scales = {-1}}));
}

TEST(Gls, LeavesOutVerticesOnNoFace) {
  Mesh mesh = surfaces::torus(2, 0.7, 80, 30);
  const GrowingLeastSquares without = built(point_set_of(mesh), {.scales = {0.5}});
  mesh.positions.emplace_back(2.7, 0, 0.1);
  mesh.positions.emplace_back(0, 0, 0);
  const GrowingLeastSquares with = built(point_set_of(mesh), {.scales = {0.5}});
  EXPECT_EQ(with.at({2.7, 0, 0}, 0).kappa, without.at({2.7, 0, 0}, 0).kappa);
  const auto all = with.at_points(0);
  ASSERT_TRUE(all);
  EXPECT_EQ(all->back().phi, 0);  // nothing within reach
  EXPECT_EQ(all->back().kappa, 0);
}

TEST(GlsScales, AreNoneThatBuildRefuses) {
  // Two outliers make the box a million times as large as what the points spread over.
  PointSet points = point_set_of(surfaces::icosphere(3));
  for (const double x : {-1e9, 1e9}) {
    points.positions.emplace_back(x, 0, 0);
    points.normals.emplace_back(1, 0, 0);
    points.areas.push_back(1);
  }
  EXPECT_TRUE(GrowingLeastSquares::build(points));
}

TEST(Spacing, OfADenseCapIsThatOfItsPoints) {
  // Many points that differ along the shorter axes alone, and many at one place: looking along the longest axis, as was
  // done, would hold every point against every other.
  PointSet points;
  for (int k = 0; k < 300'000; ++k) {
    const double a = 2.399963 * k;
    points.positions.emplace_back(k % 2 * 10.0, 1e-3 * std::sqrt(k) * std::cos(a), 1e-3 * std::sqrt(k) * std::sin(a));
    points.positions.emplace_back(0, 0, 0);
  }
  EXPECT_NEAR(spacing(points), 2e-3, 1e-3);
  EXPECT_EQ(spacing({.positions = {{1, 1, 1}, {1, 1, 1}}}), 0);
}

TEST(PointSets, WithoutAreasAreDescribedAsWithEqualOnes) {
  // In whatever unit.
  PointSet points = point_set_of(surfaces::icosphere(4, 100));
  const double apart = spacing(points);
  PointSet equal = points;
  points.areas.clear();
  equal.areas.assign(points.positions.size(), apart * apart);
  for (const auto aggregation : {GlsAggregation::ScaledHistograms, GlsAggregation::Mean}) {
    const auto a = gls_descriptor(*GrowingLeastSquares::build(points), aggregation);
    const auto b = gls_descriptor(*GrowingLeastSquares::build(equal), aggregation);
    ASSERT_TRUE(a && b);
    std::vector<float> x((*a)->width());
    std::vector<float> y((*b)->width());
    (*a)->describe(VertexId(7), x);
    (*b)->describe(VertexId(7), y);
    EXPECT_EQ(x[0], y[0]);
    EXPECT_NEAR((*a)->dissimilarity(x, y, 1), 0, 1e-6);
  }
}

}  // namespace
}  // namespace armature::sdk
