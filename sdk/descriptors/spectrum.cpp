#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <armature/sdk/descriptors/spectrum.h>
#include <armature/sdk/laplacian/sparse_factor.h>
#include <tbb/parallel_for.h>

#include "sdk/descriptors/tall_products.h"

namespace armature::sdk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kBlock = 8;
constexpr double kShift = 0.05;  // sigma, of the highest value expected
constexpr double kRounding = 1e-15;
constexpr Index kMore = 80;  // directions that are tried in any case

/// Multiplies each row by a number.
void scale_rows(Eigen::Ref<MatrixXd> w, const VectorXd& by) {
  tbb::parallel_for(Index{0}, w.cols(), [&](Index k) { w.col(k).array() *= by.array(); });
}

/// Columns that look random and are the same every time.
void scatter(Eigen::Ref<MatrixXd> columns, std::uint64_t seed) {
  for (double& x : columns.reshaped()) {
    std::uint64_t z = seed += 0x9E37'79B9'7F4A'7C15U;  // splitmix64
    z = (z ^ (z >> 30U)) * 0xBF58'476D'1CE4'E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D0'49BB'1331'11EBU;
    x = static_cast<double>((z ^ (z >> 31U)) >> 11U) * 0x1p-52 - 1;
  }
}

/// Of every part that hangs together the function that is constant on it, times the root of mass: what L takes to 0. An
/// orthonormal column each, for `most` parts.
MatrixXd constants_of(const Laplacian& laplacian, const VectorXd& root_mass, Index most) {
  const Index n = root_mass.size();
  std::vector<Index> parent(static_cast<std::size_t>(n));
  std::iota(parent.begin(), parent.end(), Index{0});
  const auto root = [&](Index v) {
    const auto up = [&](Index u) -> Index& { return parent[static_cast<std::size_t>(u)]; };
    while (up(v) != v) v = up(v) = up(up(v));
    return v;
  };
  for (Index v = 0; v < n; ++v)
    for (Eigen::SparseMatrix<double>::InnerIterator it(laplacian.stiffness, v); it; ++it)
      if (it.value() != 0)
        parent[static_cast<std::size_t>(std::max(root(v), root(it.row())))] = std::min(root(v), root(it.row()));
  std::vector<Index> column(static_cast<std::size_t>(n), -1);
  Index count = 0;
  MatrixXd constants = MatrixXd::Zero(n, most);
  for (Index v = 0; v < n; ++v) {
    if (!(root_mass[v] > 0)) continue;
    Index& k = column[static_cast<std::size_t>(root(v))];
    if (k < 0) k = count++;
    if (k < most) constants(v, k) = root_mass[v];
  }
  constants = constants.leftCols(std::min(count, most)).eval();
  constants.colwise().normalize();
  return constants;
}

/// Makes the columns of w orthonormal, and to those of q, which they are nearly; `before` is how long they were before
/// q was taken out. Where nothing new is left of a column it becomes a random one. `lean` is how far those columns of q
/// that w came from lean on the others; returns how far w does: what is left of w is short, and leans by more (Simon
/// 1984). Half of the digits are enough.
double orthonormalise(Eigen::Ref<MatrixXd> w, const Eigen::Ref<const MatrixXd>& q, const VectorXd& before,
                      const VectorXd& root_mass, double lean) {
  constexpr double kMostLean = 1e-9;
  constexpr double kNothing = 1e-12;
  constexpr double kApart = 1e-6, kWellApart = 0.1;
  constexpr int kPasses = 4;
  lean += kRounding;
  for (int pass = 0;; ++pass) {
    const VectorXd whole = pass == 0 ? before : VectorXd::Ones(w.cols());
    VectorXd length = w.colwise().norm();
    bool anew = false;
    for (Index k = 0; k < w.cols(); ++k) {
      if (!(length[k] > kNothing * whole[k])) {
        scatter(w.col(k), static_cast<std::uint64_t>(q.cols() + k + 1));
        w.col(k).array() *= root_mass.array();
        length[k] = w.col(k).norm();
        anew = true;
      }
      w.col(k) /= length[k];
    }
    const Eigen::LLT<MatrixXd> gram(dot(w, w));  // Cholesky QR
    const double least = gram.info() == Eigen::Success ? gram.matrixLLT().diagonal().minCoeff() : 0;
    if (least > kApart) {
      w = times(w, gram.matrixU().solve(MatrixXd::Identity(w.cols(), w.cols())));
    } else {
      for (Index k = 1; k < w.cols(); ++k) w.col(k) -= w.leftCols(k) * (w.leftCols(k).transpose() * w.col(k)).eval();
    }
    lean *= whole.cwiseQuotient(length).maxCoeff() / std::max(least, kApart);
    if ((!anew && least > kWellApart && lean < kMostLean) || pass == kPasses) return lean;
    subtract(w, q, dot(q, w));
    lean = kRounding;
  }
}

/// The product of the first columns of q and c, in the memory of q: there may be no room for both. Of no use where
/// `task` was stopped meanwhile.
MatrixXd times_in_place(MatrixXd q, Index columns, const MatrixXd& c, const Task& task) {
  constexpr Index kRows = 1 << 16;
  for (Index first = 0; first < q.rows() && !task.stopped(); first += kRows) {
    const Index rows = std::min(kRows, q.rows() - first);
    q.block(first, 0, rows, c.cols()) = times(q.block(first, 0, rows, columns), c);
  }
  q.conservativeResize(Eigen::NoChange, c.cols());
  return q;
}

}  // namespace

Expected<Spectrum> spectrum(const Mesh& mesh, const Laplacian& laplacian, const SpectrumOptions& options,
                            const Task& task) {
  const auto n = static_cast<Index>(mesh.positions.size());
  const VectorXd& mass = laplacian.mass;
  const Index live = (mass.array() > 0).count();
  if (live == 0) return fail("the mesh has no face with an area; its surface has no spectrum");
  if (options.count == 0) return fail("count: expected one eigenpair or more");
  if (options.most == 0) return fail("most: expected 1 or more");
  const auto at_most_live = [&](std::size_t wanted) {
    return static_cast<Index>(std::min(wanted, static_cast<std::size_t>(live)));
  };
  const Index count = at_most_live(options.count);
  const VectorXd root_mass = mass.cwiseMax(0).cwiseSqrt();
  const double expected_top = 4 * std::numbers::pi * static_cast<double>(count) / mass.sum();  // Weyl's law
  const double sigma = kShift * expected_top;

  Eigen::SparseMatrix<double> shifted = laplacian.stiffness;
  for (Index v = 0; v < n; ++v) shifted.coeffRef(v, v) += mass[v] > 0 ? sigma * mass[v] : 1;
  const auto factor = SparseFactor::of(shifted, mesh.positions, task);
  if (!factor) return tl::unexpected(factor.error());

  // Q' A Q with A = M^1/2 (L + sigma M)^-1 M^1/2, whose largest values belong to the lowest of L.
  const Index most = std::min(live, at_most_live(options.most) * count + kMore);
  MatrixXd q(n, most);
  MatrixXd projected = MatrixXd::Zero(most, most);
  // Constants are known, and as many as components: blocks would miss some of more than their width.
  const MatrixXd constants = constants_of(laplacian, root_mass, std::min(count, most - 1));
  Index size = constants.cols();
  q.leftCols(size) = constants;
  projected.diagonal().head(size).setConstant(1 / sigma);
  Index width = std::min(kBlock, most - size);
  MatrixXd w(n, width);
  scatter(w, 0);
  w.array().colwise() *= root_mass.array();
  Eigen::SelfAdjointEigenSolver<MatrixXd> ritz;
  VectorXd before = w.colwise().norm();
  subtract(w, constants, dot(constants, w));
  MatrixXd left;                  // by wanted pair: what A q leaves outside of all directions, of w
  std::array<double, 2> leans{};  // of the last two blocks, which A times the last is made of but for what is new
  while (true) {
    const double lean = orthonormalise(w, q.leftCols(size), before, root_mass, std::max(leans[0], leans[1]));
    leans = {leans[1], lean};
    q.middleCols(size, width) = w;
    scale_rows(w, root_mass);
    if (task.stopped()) return cancelled();
    factor->solve(w);
    if (task.stopped()) return cancelled();
    scale_rows(w, root_mass);
    before = w.colwise().norm();
    const MatrixXd column = dot(q.leftCols(size + width), w);
    projected.block(0, size, size + width, width) = column;
    projected.block(size, 0, width, size + width) = column.transpose();
    subtract(w, q.leftCols(size + width), column);
    size += width;
    if (task.stopped()) return cancelled();
    task.report("eigenfunctions", std::min(1.0, static_cast<double>(size) / static_cast<double>(3 * count)));
    // Looking takes as long as a block: not before it is likely to help, and then after every third.
    if (size == most || (size >= 3 * count && size / kBlock % 3 == 0)) {
      ritz.compute(projected.topLeftCorner(size, size));
      left = ritz.eigenvectors().bottomRows(width).rightCols(count);
      const VectorXd length2 = left.cwiseProduct(dot(w, w) * left).colwise().sum().transpose().cwiseMax(0);
      const VectorXd theta = ritz.eigenvalues().tail(count);
      if (size == most || length2.cwiseSqrt().cwiseQuotient(theta).maxCoeff() < options.tolerance) break;
    }
    width = std::min(kBlock, most - size);
    if (width < w.cols()) w = w.leftCols(width).eval();
    before.conservativeResize(width);
  }

  Spectrum result;
  const VectorXd theta = ritz.eigenvalues().tail(count);
  result.values = (theta.cwiseInverse().array() - sigma).cwiseMax(0).reverse();
  // A q, which is known without another solve, is purer than q (Nour-Omid, Parlett, Ericsson, Jensen 1987).
  result.functions = times_in_place(std::move(q), size, ritz.eigenvectors().rightCols(count).rowwise().reverse(), task);
  if (task.stopped()) return cancelled();
  subtract(result.functions, w, -(left * theta.cwiseInverse().asDiagonal()).rowwise().reverse());
  const double mean = result.values.mean();
  result.residuals.resize(count);
  tbb::parallel_for(Index{0}, count, [&](Index k) {
    if (task.stopped()) return;
    auto phi = result.functions.col(k);
    phi = (root_mass.array() > 0).select(phi.normalized().cwiseQuotient(root_mass), 0.0);
    const VectorXd off = laplacian.stiffness * phi - result.values[k] * mass.cwiseProduct(phi);
    const double residual = (root_mass.array() > 0).select(off.cwiseQuotient(root_mass), 0.0).matrix().norm();
    result.residuals[k] = residual / std::max(result.values[k] + mean, sigma);
  });
  if (task.stopped()) return cancelled();
  result.converged = static_cast<std::size_t>((result.residuals.array() <= options.tolerance).count());
  return result;
}

}  // namespace armature::sdk
