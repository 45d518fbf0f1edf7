#include "tools/evaluation/bounded_biharmonic.h"

#include <algorithm>
#include <optional>
#include <vector>

#include <Eigen/SparseCholesky>

namespace armature::tools {

using Matrix = Eigen::SparseMatrix<double>;

BoundedBiharmonic bounded_biharmonic_weights(const sdk::Laplacian& laplacian, std::span<const sdk::VertexId> handles,
                                             std::size_t handle) {
  const Matrix& L = laplacian.stiffness;
  const Eigen::Index n = L.rows();
  const double least = 1e-12 * laplacian.mass.sum() / static_cast<double>(n);
  const Eigen::VectorXd inverse_mass = laplacian.mass.cwiseMax(least).cwiseInverse();
  const Matrix Q = L * inverse_mass.asDiagonal() * L;
  std::vector<std::optional<double>> bound(static_cast<std::size_t>(n));
  for (std::size_t h = 0; h < handles.size(); ++h) bound[handles[h].index()] = h == handle ? 1 : 0;

  BoundedBiharmonic result;
  constexpr int kMost = 20;
  constexpr double kTolerance = 1e-6;
  for (bool changed = true; changed && result.factorisations < kMost;) {
    std::vector<Eigen::Index> place(bound.size(), -1);
    Eigen::Index free = 0;
    for (std::size_t v = 0; v < bound.size(); ++v)
      if (!bound[v]) place[v] = free++;
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd b = Eigen::VectorXd::Zero(free);
    for (Eigen::Index column = 0; column < n; ++column)
      for (Matrix::InnerIterator entry(Q, column); entry; ++entry) {
        const Eigen::Index row = place[static_cast<std::size_t>(entry.row())];
        if (row < 0) continue;
        if (const auto& known = bound[static_cast<std::size_t>(column)])
          b[row] -= entry.value() * *known;
        else
          entries.emplace_back(row, place[static_cast<std::size_t>(column)], entry.value());
      }
    Matrix A(free, free);
    A.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Matrix> factor(A);
    ++result.factorisations;
    const Eigen::VectorXd x = factor.solve(b);
    changed = false;
    result.weights.resize(n);
    for (std::size_t v = 0; v < bound.size(); ++v) {
      const double weight = bound[v] ? *bound[v] : x[place[v]];
      result.weights[static_cast<Eigen::Index>(v)] = weight;
      if (bound[v] || (weight > -kTolerance && weight < 1 + kTolerance)) continue;
      bound[v] = weight < 0 ? 0 : 1;
      changed = true;
    }
  }
  return result;
}

}  // namespace armature::tools
