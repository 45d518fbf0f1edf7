#include <random>
#include <vector>

#include <armature/sdk/laplacian/laplacian.h>
#include <armature/sdk/laplacian/sparse_factor.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/sdk/mesh/surfaces.h"

namespace armature::sdk {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct System {
  Mesh mesh;
  Eigen::SparseMatrix<double> A;
};

System system_of(Mesh mesh) {
  Eigen::SparseMatrix<double> A = laplacian(mesh, Adjacency(mesh)).stiffness;
  for (Eigen::Index i = 0; i < A.rows(); ++i) A.coeffRef(i, i) += 1e-3;
  return {std::move(mesh), std::move(A)};
}

double residual(const Eigen::SparseMatrix<double>& A, const MatrixXd& x, const MatrixXd& b) {
  return (A * x - b).norm() / b.norm();
}

TEST(SparseFactor, SolvesForOneAndForManyRightHandSides) {
  const System system = system_of(surfaces::torus(3, 1, 80, 50, 0.3));
  const auto factor = SparseFactor::of(system.A, system.mesh.positions).value();
  for (const Eigen::Index columns : {1, 5, 40}) {
    const MatrixXd b = MatrixXd::Random(system.A.rows(), columns);
    MatrixXd x = b;
    factor.solve(x);
    EXPECT_LT(residual(system.A, x, b), 1e-12);
  }
}

TEST(SparseFactor, FollowsChangesOfTheDiagonalAndTakesThemBackBitByBit) {
  const System system = system_of(surfaces::icosphere(4));
  auto factor = SparseFactor::of(system.A, system.mesh.positions).value();
  const VectorXd b = VectorXd::Random(system.A.rows());
  VectorXd before = b;
  factor.solve(before);

  Eigen::SparseMatrix<double> changed = system.A;
  std::mt19937_64 random(3);
  std::vector<VertexId> vertices;
  for (int i = 0; i < 30; ++i) vertices.emplace_back(random() % system.mesh.positions.size());
  for (const VertexId v : vertices) {
    factor.add_to_diagonal(v, 1e4);
    changed.coeffRef(static_cast<Eigen::Index>(v.index()), static_cast<Eigen::Index>(v.index())) += 1e4;
  }
  VectorXd x = b;
  factor.solve(x);
  EXPECT_LT(residual(changed, x, b), 1e-12);

  for (const VertexId v : vertices) factor.add_to_diagonal(v, -1e4);
  x = b;
  factor.solve(x);
  EXPECT_LT((x - before).norm() / before.norm(), 1e-6);
  factor.reset();
  x = b;
  factor.solve(x);
  EXPECT_EQ(x, before);
}

TEST(SparseFactor, SolvesForFewEntriesAsForAll) {
  const System system = system_of(surfaces::icosphere(4));
  const auto factor = SparseFactor::of(system.A, system.mesh.positions).value();
  const std::vector<SparseFactor::Entry> entries = {{VertexId(5), 2.0}, {VertexId(700), -1.0}, {VertexId(5), 0.5}};
  VectorXd b = VectorXd::Zero(system.A.rows());
  for (const auto& [vertex, value] : entries) b[static_cast<Eigen::Index>(vertex.index())] += value;
  VectorXd x = b;
  factor.solve(x);
  EXPECT_EQ(factor.solve(entries), x);
}

TEST(SparseFactor, IsTheSameBitsOnAnyNumberOfThreads) {
  const System system = system_of(surfaces::icosphere(6));
  const VectorXd b = VectorXd::Random(system.A.rows());
  std::vector<VectorXd> solutions;
  for (const std::size_t threads : {1U, 4U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    solutions.push_back(b);
    SparseFactor::of(system.A, system.mesh.positions).value().solve(solutions.back());
  }
  EXPECT_EQ(solutions[0], solutions[1]);
}

TEST(SparseFactor, StoresLittleMoreThanTheMatrix) {
  const System system = system_of(surfaces::icosphere(5));
  const auto factor = SparseFactor::of(system.A, system.mesh.positions).value();
  EXPECT_LT(factor.entry_count(), 50 * factor.size());
}

TEST(SparseFactor, IsIndependentOfItsCopies) {
  const System system = system_of(surfaces::icosphere(3));
  auto factor = SparseFactor::of(system.A, system.mesh.positions).value();
  const VectorXd b = VectorXd::Random(system.A.rows());
  VectorXd x = b;
  factor.solve(x);
  SparseFactor copy = factor;
  copy.add_to_diagonal(VertexId(0), 10);
  VectorXd again = b;
  factor.solve(again);
  EXPECT_EQ(x, again);
}

TEST(SparseFactor, RefusesWhatIsNotPositiveDefiniteOrDoesNotFit) {
  System system = system_of(surfaces::icosphere(3));
  system.A.coeffRef(7, 7) = -1;
  const auto indefinite = SparseFactor::of(system.A, system.mesh.positions);
  ASSERT_FALSE(indefinite);
  EXPECT_EQ(indefinite.error().message, "the matrix is not positive definite");
  EXPECT_FALSE(SparseFactor::of(system.A, std::span(system.mesh.positions).first(5)));
  EXPECT_EQ(SparseFactor::of(Eigen::SparseMatrix<double>(0, 0), {}).value().size(), 0);
}

TEST(SparseFactor, StopsOnRequest) {
  const System system = system_of(surfaces::icosphere(3));
  std::stop_source source;
  source.request_stop();
  const auto stopped = SparseFactor::of(system.A, system.mesh.positions, {.stop = source.get_token()});
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::Cancelled);
}

TEST(SparseFactor, TakesPositionsThatFallTogether) {
  System system = system_of(surfaces::icosphere(3));
  const std::vector<Eigen::Vector3d> nowhere(system.mesh.positions.size(), Eigen::Vector3d::Zero());
  const auto factor = SparseFactor::of(system.A, nowhere).value();
  const VectorXd b = VectorXd::Random(system.A.rows());
  VectorXd x = b;
  factor.solve(x);
  EXPECT_LT(residual(system.A, x, b), 1e-12);
}

}  // namespace
}  // namespace armature::sdk
