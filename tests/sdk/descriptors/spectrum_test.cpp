#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <armature/sdk/descriptors/descriptors.h>
#include <armature/sdk/descriptors/spectrum.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/sdk/mesh/surfaces.h"

namespace armature::sdk {
namespace {

Laplacian laplacian_of(const Mesh& mesh) {
  return laplacian(mesh, Adjacency(mesh));
}

Spectrum spectrum_of(const Mesh& mesh, const SpectrumOptions& options = {}) {
  auto found = spectrum(mesh, laplacian_of(mesh), options);
  EXPECT_TRUE(found.has_value()) << (found ? "" : found.error().message);
  return std::move(*found);
}

/// A sheet in the plane, and the same rolled up to most of a cylinder: isometric as surfaces.
Mesh sheet(int cells, bool rolled) {
  return surfaces::over({2 * cells, cells, false, false, 0.2}, [&](double i, double j) {
    const double x = 2 * i + 0.3 * j * i;
    return rolled ? Eigen::Vector3d(std::cos(x), std::sin(x), j) : Eigen::Vector3d(x, j, 0);
  });
}

TEST(Spectrum, OfASphereIsThatOfSphericalHarmonics) {
  const Spectrum s = spectrum_of(surfaces::icosphere(5), {.count = 49});
  EXPECT_EQ(s.converged, 49U);
  EXPECT_LT(s.residuals.maxCoeff(), 1e-6);
  for (int l = 0; l < 7; ++l)
    for (int m = 0; m < 2 * l + 1; ++m) EXPECT_NEAR(s.values[l * l + m], l * (l + 1), 0.005 * l * (l + 1) + 1e-9);
}

TEST(Spectrum, AgreesWithDenseSolving) {
  const Mesh mesh = surfaces::torus(2, 0.7, 24, 12, 0.3);
  const Laplacian l = laplacian_of(mesh);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> dense(
      Eigen::MatrixXd(l.stiffness), Eigen::MatrixXd(l.mass.asDiagonal()), Eigen::EigenvaluesOnly);
  const Spectrum s = spectrum_of(mesh, {.count = 60});
  for (Eigen::Index k = 0; k < 60; ++k) EXPECT_NEAR(s.values[k], dense.eigenvalues()[k], 1e-8) << k;
  const Eigen::MatrixXd gram = s.functions.transpose() * l.mass.asDiagonal() * s.functions;
  EXPECT_NEAR((gram - Eigen::MatrixXd::Identity(60, 60)).cwiseAbs().maxCoeff(), 0, 1e-8);
}

TEST(Spectrum, HasAZeroForEachComponentAndNothingOnLooseVertices) {
  Mesh mesh = surfaces::together(surfaces::icosphere(2), surfaces::moved(surfaces::icosphere(2), {5, 0, 0}));
  mesh.positions.emplace_back(9, 9, 9);
  const Spectrum s = spectrum_of(mesh, {.count = 10});
  EXPECT_NEAR(s.values[1], 0, 1e-9);
  EXPECT_GT(s.values[2], 1);
  EXPECT_TRUE(s.functions.bottomRows(1).isZero(0));
}

TEST(Spectrum, IsWholeForASmallMesh) {
  const Spectrum s = spectrum_of(surfaces::cube(), {.count = 100});
  EXPECT_EQ(s.values.size(), 8);
  EXPECT_EQ(s.converged, 8U);
  EXPECT_FALSE(spectrum(Mesh{.positions = {{0, 0, 0}}}, laplacian_of(Mesh{.positions = {{0, 0, 0}}})));
}

TEST(Spectrum, ConvergesOnRegularSheetsAndForFewPairs) {
  // Directions that are made orthogonal once lean on one another more and more as pairs converge.
  for (const int cells : {15, 30})
    for (const std::size_t count : {5U, 20U, 100U}) {
      const Spectrum s = spectrum_of(sheet(cells, false), {.count = count});
      EXPECT_EQ(s.converged, count) << cells;
      EXPECT_GT(s.values[1], 1);
    }
}

TEST(Spectrum, IsTheSameOnOneThread) {
  const Mesh mesh = surfaces::torus(2, 0.7, 120, 40, 0.3);
  const Spectrum many = spectrum_of(mesh, {.count = 30});
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Spectrum alone = spectrum_of(mesh, {.count = 30});
  EXPECT_EQ(many.values, alone.values);
  EXPECT_EQ(many.functions, alone.functions);
}

TEST(Signatures, StayTheSameUnderIsometriesWithinTheDiscretisation) {
  // Rolled up, chords are shorter than arcs by about h^2 / 24: 1.2e-5 of their length at 60 cells, 2.6e-5 where cells
  // are widest; eigenvalues rise by twice that at most, and exp(-t lambda), t lambda being 9.2 or less, by 5e-4.
  const Mesh flat = sheet(60, false);
  const Mesh rolled = sheet(60, true);
  const Laplacian of_flat = laplacian_of(flat);
  const Laplacian of_rolled = laplacian_of(rolled);
  const Spectrum a = spectrum_of(flat);
  const Spectrum b = spectrum_of(rolled);
  for (const auto& signature : {heat_kernel_signature, wave_kernel_signature, scale_invariant_heat_kernel_signature}) {
    const auto here = signature(a, of_flat);
    const auto there = signature(b, of_rolled);
    std::vector<float> x(here->width());
    std::vector<float> y(here->width());
    double worst = 0;
    double usual = 0;
    for (std::size_t v = 0; v < flat.positions.size(); ++v) {
      here->describe(VertexId(v), x);
      there->describe(VertexId(v), y);
      worst = std::max(worst, here->dissimilarity(x, y, 1));
      here->describe(VertexId(0), y);
      usual += here->dissimilarity(x, y, 1) / static_cast<double>(flat.positions.size());
    }
    EXPECT_LT(worst, 5e-4);
    EXPECT_GT(usual, 20 * worst);  // against how unlike other places are
  }
}

TEST(Signatures, TellHowLargeComponentsAreWhereASpectrumHoldsNothingElse) {
  Mesh mesh;
  for (int k = 0; k < 12; ++k)
    mesh = surfaces::together(std::move(mesh), surfaces::moved(surfaces::cube(), {3.0 * k, 0, 0}, k < 6 ? 1 : 0.5));
  const Laplacian l = laplacian_of(mesh);
  const Spectrum s = spectrum_of(mesh, {.count = 12});
  EXPECT_NEAR(s.values.maxCoeff(), 0, 1e-9);
  for (const auto& signature : {heat_kernel_signature, wave_kernel_signature, scale_invariant_heat_kernel_signature}) {
    const auto found = signature(s, l);
    std::vector<float> first(found->width());
    std::vector<float> like(found->width());
    found->describe(VertexId(0), first);
    found->describe(VertexId(9), like);
    EXPECT_NEAR(found->dissimilarity(first, like, 1), 0, 1e-6);
    for (const float x : first) EXPECT_TRUE(std::isfinite(x));
  }
}

TEST(Signatures, OfHeatWithoutScaleStayTheSameAtAnySize) {
  const Mesh mesh = surfaces::torus(2, 0.7, 60, 30, 0.3);
  const Mesh large = surfaces::moved(mesh, {3, 4, 5}, 10);
  const auto here = scale_invariant_heat_kernel_signature(spectrum_of(mesh), laplacian_of(mesh));
  const auto there = scale_invariant_heat_kernel_signature(spectrum_of(large), laplacian_of(large));
  std::vector<float> x(here->width());
  std::vector<float> y(here->width());
  for (std::size_t v = 0; v < mesh.positions.size(); v += 17) {
    here->describe(VertexId(v), x);
    there->describe(VertexId(v), y);
    EXPECT_LT(here->dissimilarity(x, y, 1), 1e-3);
  }
}

}  // namespace
}  // namespace armature::sdk
