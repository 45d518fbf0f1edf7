#pragma once

#include <memory>
#include <span>

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <armature/sdk/error.h>
#include <armature/sdk/mesh/ids.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// The Cholesky factor of a sparse symmetric positive definite matrix with a row for each vertex of a mesh, such as
/// L + eps M. The diagonal can be changed and changed back without factoring again: a change touches only the columns
/// between the vertex and the root of the elimination tree and makes no new entries (Davis and Hager 1999).
///
/// Not thread-safe while it is changed; solves may run side by side.
class SparseFactor {
 public:
  /// Factors `matrix`, [V][V], of which the lower triangle is read. `positions`, [V], only help to find a good order.
  /// Fails on a matrix that is not positive definite. Uses all cores; the same bits on any number of them.
  [[nodiscard]] static Expected<SparseFactor> of(const Eigen::SparseMatrix<double>& matrix,
                                                 std::span<const Eigen::Vector3d> positions, const Task& task = {});
  ~SparseFactor();
  SparseFactor(const SparseFactor& other);             ///< a factor of its own, with the changes of the other
  SparseFactor& operator=(const SparseFactor& other);  ///< likewise
  SparseFactor(SparseFactor&&) noexcept;
  SparseFactor& operator=(SparseFactor&&) noexcept;

  /// Adds `amount` to the diagonal entry of a vertex. A negative amount takes back what an earlier call added: exact to
  /// rounding, which `reset()` clears. The matrix must stay positive definite.
  void add_to_diagonal(VertexId vertex, double amount);
  /// Takes all changes back, bit by bit.
  void reset();

  /// Overwrites b with the solution x of A x = b; [V] or [V][k], a column a right-hand side.
  void solve(Eigen::Ref<Eigen::MatrixXd> b) const;
  /// One entry of a right-hand side.
  struct Entry {
    VertexId vertex;   ///< its row
    double value = 0;  ///< not zero
  };
  /// The solution for a right-hand side of few entries, which costs half as much.
  [[nodiscard]] Eigen::VectorXd solve(std::span<const Entry> b) const;
  /// That solution at some vertices alone: x[i] is its value at wanted[i]. Costs what lies above the entries and the
  /// wanted vertices in the elimination tree: little where both lie close together.
  void solve(std::span<const Entry> b, std::span<const VertexId> wanted, std::span<double> x) const;

  /// How many vertices there are.
  [[nodiscard]] std::size_t size() const noexcept;
  /// How many entries the factor stores.
  [[nodiscard]] std::size_t entry_count() const noexcept;

 private:
  struct State;
  explicit SparseFactor(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace armature::sdk
