#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <random>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/laplacian/laplacian.h>
#include <armature/sdk/laplacian/sparse_factor.h>
#include <armature/sdk/mesh/measures.h>
#include <gtest/gtest.h>

#include "tests/sdk/mesh/surfaces.h"

namespace armature::sdk {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

Laplacian laplacian_of(const Mesh& mesh) {
  return laplacian(mesh, Adjacency(mesh));
}

/// The cotangents of the mesh as it is.
MatrixXd plain_cotangents(const Mesh& mesh) {
  const auto n = static_cast<Eigen::Index>(mesh.positions.size());
  MatrixXd L = MatrixXd::Zero(n, n);
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = static_cast<Eigen::Index>(mesh.triangles[f][k].index());
      const auto b = static_cast<Eigen::Index>(mesh.triangles[f][(k + 1) % 3].index());
      const Vector3d& apex = mesh.corner(FaceId(f), (k + 2) % 3);
      const Vector3d u = mesh.corner(FaceId(f), k) - apex;
      const Vector3d v = mesh.corner(FaceId(f), (k + 1) % 3) - apex;
      const double weight = 0.5 * u.dot(v) / u.cross(v).norm();
      L(a, b) -= weight;
      L(b, a) -= weight;
      L(a, a) += weight;
      L(b, b) += weight;
    }
  return L;
}

/// What holds for every mesh: symmetric, rows sum to 0, nothing positive off the diagonal, no negative energy.
void expect_sound(const Mesh& mesh) {
  const auto [L, mass] = laplacian_of(mesh);
  const MatrixXd dense = L;
  ASSERT_TRUE(dense.allFinite());
  const double scale = std::max(1.0, dense.diagonal().maxCoeff());
  EXPECT_LT((dense - dense.transpose()).cwiseAbs().maxCoeff(), 1e-12 * scale);
  EXPECT_LT(dense.rowwise().sum().cwiseAbs().maxCoeff(), 1e-12 * scale * static_cast<double>(dense.rows()));
  for (Eigen::Index i = 0; i < dense.rows(); ++i)
    for (Eigen::Index j = 0; j < dense.cols(); ++j)
      if (i != j) {
        EXPECT_LE(dense(i, j), 0);
      }
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<MatrixXd>(dense).eigenvalues().minCoeff(), -1e-10 * scale);
  EXPECT_GE(mass.minCoeff(), 0);
  // A sliver whose sides grow by a millionth becomes about a thousandth high.
  EXPECT_NEAR(mass.sum(), surface_area(mesh), 2e-3 * surface_area(mesh) + 1e-12);
}

/// A closed surface with jittered vertices: far from Delaunay.
Mesh crumpled() {
  Mesh mesh = surfaces::torus(3, 1, 16, 9, 0.45);
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> shift(-0.15, 0.15);
  for (Vector3d& p : mesh.positions) p += Vector3d(shift(random), shift(random), shift(random));
  return mesh;
}

TEST(Laplacian, IsPositiveSemiDefiniteWithoutPositiveWeightsOnAnyMesh) {
  expect_sound(surfaces::cube());
  expect_sound(surfaces::icosphere(2));
  expect_sound(crumpled());
  expect_sound(surfaces::paraboloid(1, -2, 8, 0.4));
}

TEST(Laplacian, SurvivesDegenerateDuplicateAndNonManifoldFaces) {
  using surfaces::mesh_of;
  // Three faces at an edge; the same face twice; corners on a line; a vertex twice; two equal positions.
  const std::vector<Vector3d> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5, -1, 0}, {2, 0, 0}, {0, 1, 0}};
  expect_sound(mesh_of(points, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}}));
  expect_sound(mesh_of(points, {{0, 1, 2}, {0, 1, 2}, {2, 1, 0}, {1, 2, 3}}));
  expect_sound(mesh_of(points, {{0, 1, 2}, {0, 1, 5}, {5, 2, 1}}));
  expect_sound(mesh_of(points, {{0, 1, 2}, {0, 0, 2}, {1, 2, 1}}));
  expect_sound(mesh_of(points, {{0, 1, 2}, {1, 2, 6}, {0, 2, 6}}));
  expect_sound(mesh_of(points, {{0, 1, 2}}));
  expect_sound(mesh_of(points, {}));
  // Faces that disagree on what is outside.
  Mesh disagreeing = surfaces::cube();
  std::swap(disagreeing.triangles[3][0], disagreeing.triangles[3][1]);
  expect_sound(disagreeing);
}

TEST(Laplacian, HasTheMeshsOwnCotangentsWhereThatIsDelaunay) {
  const Mesh closed = surfaces::icosphere(2);
  EXPECT_LT((MatrixXd(laplacian_of(closed).stiffness) - plain_cotangents(closed)).cwiseAbs().maxCoeff(), 1e-9);
  Mesh open = closed;
  open.triangles.resize(200);
  EXPECT_LT((MatrixXd(laplacian_of(open).stiffness) - plain_cotangents(open)).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Laplacian, DoesNotDependOnTheDiagonalsOfAFlatMesh) {
  // The same points, cut along the long diagonals of a sheared grid or along the short ones.
  const auto sheared = [](double i, double j) { return Vector3d(i + 0.7 * j, j, 0); };
  const Mesh good = surfaces::over({10, 10, false, false, 0}, sheared);
  Mesh bad = good;
  for (std::size_t f = 0; f + 1 < bad.triangles.size(); f += 2) {
    const auto [a, b, c] = good.triangles[f];
    const VertexId d = good.triangles[f + 1][2];
    bad.triangles[f] = {a, b, d};
    bad.triangles[f + 1] = {b, c, d};
  }
  const MatrixXd difference = laplacian_of(good).stiffness - laplacian_of(bad).stiffness;
  EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Laplacian, OfALinearFunctionIsZeroWithinAFlatMesh) {
  const Mesh flat = surfaces::paraboloid(0, 0, 20, 0.3);
  const auto [L, mass] = laplacian_of(flat);
  VectorXd f(L.rows());
  for (Eigen::Index i = 0; i < f.size(); ++i) {
    const Vector3d& p = flat.positions[static_cast<std::size_t>(i)];
    f[i] = 3 * p.x() - 2 * p.y() + 1;
  }
  const VectorXd residual = L * f;
  for (Eigen::Index i = 0; i < f.size(); ++i)
    if (flat.positions[static_cast<std::size_t>(i)].head<2>().cwiseAbs().maxCoeff() < 0.7) {
      EXPECT_NEAR(residual[i], 0, 1e-9);
    }
}

TEST(Laplacian, OfASphereHasTheEigenvaluesOfASphere) {
  const auto [L, mass] = laplacian_of(surfaces::icosphere(3, 2));
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(MatrixXd(L), MatrixXd(mass.asDiagonal()));
  // l (l + 1) / r^2, 2 l + 1 of each.
  const std::array<double, 9> expected = {0, 0.5, 0.5, 0.5, 1.5, 1.5, 1.5, 1.5, 1.5};
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(solver.eigenvalues()[static_cast<Eigen::Index>(i)], expected[i], 0.02);
}

TEST(Laplacian, KeepsHarmonicFunctionsBetweenTheirBoundaryValues) {
  // Two components, one of them with thin triangles; constraints by penalty on the first.
  const Mesh other = surfaces::moved(surfaces::paraboloid(1, 1, 6, 0.4), {10, 0, 0});
  const Mesh mesh = surfaces::together(crumpled(), other);
  auto [A, mass] = laplacian_of(mesh);
  for (Eigen::Index i = 0; i < A.rows(); ++i) A.coeffRef(i, i) += 1e-8;
  auto factor = SparseFactor::of(A, mesh.positions).value();
  const double weight = 1e4;
  for (const std::size_t v : {3U, 40U, 77U, 100U}) factor.add_to_diagonal(VertexId(v), weight);
  const std::vector<SparseFactor::Entry> ones = {{VertexId(3), weight}, {VertexId(77), weight}};
  const VectorXd field = factor.solve(ones);
  EXPECT_GE(field.minCoeff(), 0);
  EXPECT_LE(field.maxCoeff(), 1);
  EXPECT_GT(field[3], 0.99);
  EXPECT_LT(field[40], 0.01);
  EXPECT_EQ(field.tail(static_cast<Eigen::Index>(other.positions.size())).cwiseAbs().maxCoeff(), 0);
}

TEST(Laplacian, OfRealModelsIsSound) {
  for (const char* name : {"ca_ants27.off", "vm_spider.off", "ml_trim-star.off", "iglt_degenerated.obj"}) {
    const auto path = std::filesystem::path("../shared/data/meshes") / name;
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
    const Mesh mesh = read_mesh(path.string()).value();
    const auto [L, mass] = laplacian_of(mesh);
    double worst = 0;
    for (Eigen::Index k = 0; k < L.outerSize(); ++k)
      for (Eigen::SparseMatrix<double>::InnerIterator entry(L, k); entry; ++entry) {
        ASSERT_TRUE(std::isfinite(entry.value()));
        if (entry.row() != entry.col()) worst = std::max(worst, entry.value());
      }
    EXPECT_LE(worst, 0) << name;
  }
}

}  // namespace
}  // namespace armature::sdk
