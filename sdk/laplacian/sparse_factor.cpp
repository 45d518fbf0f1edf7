#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <armature/sdk/laplacian/sparse_factor.h>
#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include "sdk/laplacian/block_structure.h"
#include "sdk/laplacian/factorisation.h"
#include "sdk/laplacian/four_columns.h"

namespace armature::sdk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using ConstPanel = Eigen::Map<const MatrixXd>;

/// The columns of a block: what they hold and which rows.
struct Block {
  ConstPanel L;
  std::span<const std::uint32_t> rows;  ///< below the block's own
  Index first;
  Index width;
  Index below;
};

}  // namespace

struct SparseFactor::State {
  std::shared_ptr<const BlockStructure> structure;
  std::vector<std::size_t> entries;  ///< in the subtree of each block
  std::vector<double> values;        ///< panel behind panel
  /// By block: the panel as it was before the first change; empty where nothing changed.
  std::vector<std::vector<double>> original;
  std::vector<std::uint32_t> changed;
  std::vector<double> column;  ///< the vector of a change, gathered for a block

  [[nodiscard]] Block at(std::size_t block) const {
    const auto height = static_cast<Index>(structure->height(block));
    const auto width = static_cast<Index>(structure->width(block));
    return {{values.data() + structure->value_starts[block], height, width},
            structure->rows(block),
            static_cast<Index>(structure->first(block)),
            width,
            height - width};
  }

  /// The blocks that hold the vertices, and all above them, children first.
  template <class Elements, class VertexOf>
  std::vector<std::uint32_t> blocks_above(const Elements& elements, VertexOf&& vertex_of) const {
    std::vector<bool> seen(structure->blocks(), false);
    std::vector<std::uint32_t> blocks;
    for (const auto& element : elements)
      for (std::uint32_t block = structure->block_of[structure->new_place[vertex_of(element).index()]];
           block != BlockStructure::kRoot && !seen[block]; block = structure->parents[block]) {
        seen[block] = true;
        blocks.push_back(block);
      }
    std::sort(blocks.begin(), blocks.end());
    return blocks;
  }

  /// x = L^-1 b in the new order, where only blocks above an entry differ from zero.
  VectorXd forward(std::span<const Entry> b) const;
  /// x = L^-1 x for the rows of a block, and what that takes from the rows below; x in the new order.
  void forward(std::size_t block, Eigen::Ref<VectorXd> x) const;
  /// x = L^-T x for the rows of a block, given those below.
  void backward(std::size_t block, Eigen::Ref<VectorXd> x) const;
  /// All blocks backward, parents first, subtrees side by side.
  void backward(Eigen::Ref<VectorXd> x) const;
  void backward_subtree(std::uint32_t block, Eigen::Ref<VectorXd>& x) const;
};

Expected<SparseFactor> SparseFactor::of(const Eigen::SparseMatrix<double>& matrix,
                                        std::span<const Eigen::Vector3d> positions, const Task& task) {
  if (matrix.rows() != matrix.cols() || static_cast<std::size_t>(matrix.rows()) != positions.size())
    return fail("a matrix of " + std::to_string(matrix.rows()) + " by " + std::to_string(matrix.cols()) + " for " +
                std::to_string(positions.size()) + " vertices: expected a row and a column for each");
  if (!matrix.isCompressed()) {
    Eigen::SparseMatrix<double> compressed = matrix;
    compressed.makeCompressed();
    return of(compressed, positions, task);
  }
  task.report("ordering", 0);
  auto state = std::make_unique<State>();
  Dissection dissection = nested_dissection(matrix, positions, task);
  if (task.stopped()) return cancelled();
  auto structure = std::make_shared<BlockStructure>(block_structure(matrix, std::move(dissection)));
  if (task.stopped()) return cancelled();
  task.report("factoring", 0);
  state->entries = subtree_entries(*structure);
  state->values.resize(structure->value_starts.back());
  state->original.resize(structure->blocks());
  const std::uint32_t failed = factorise(matrix, *structure, state->entries, task, state->values);
  if (task.stopped()) return cancelled();
  if (failed != BlockStructure::kRoot) return fail("the matrix is not positive definite");
  state->structure = std::move(structure);
  return SparseFactor(std::move(state));
}

SparseFactor::SparseFactor(std::unique_ptr<State> state) : state_(std::move(state)) {}
SparseFactor::~SparseFactor() = default;
SparseFactor::SparseFactor(const SparseFactor& other) : state_(std::make_unique<State>(*other.state_)) {}
SparseFactor& SparseFactor::operator=(const SparseFactor& other) {
  if (this != &other) state_ = std::make_unique<State>(*other.state_);
  return *this;
}
SparseFactor::SparseFactor(SparseFactor&&) noexcept = default;
SparseFactor& SparseFactor::operator=(SparseFactor&&) noexcept = default;

std::size_t SparseFactor::size() const noexcept {
  return state_->structure->order.size();
}
std::size_t SparseFactor::entry_count() const noexcept {
  return state_->values.size();
}

void SparseFactor::add_to_diagonal(VertexId vertex, double amount) {
  if (amount == 0) return;
  const BlockStructure& structure = *state_->structure;
  const std::uint32_t column = structure.new_place[vertex.index()];
  const double sign = amount > 0 ? 1 : -1;
  // L L' + sign w w', a column after the other (Gill, Golub, Murray and Saunders 1974, method C1).
  std::vector<std::pair<std::uint32_t, double>> w = {{column, std::sqrt(std::abs(amount))}};
  for (std::uint32_t block = structure.block_of[column]; block != BlockStructure::kRoot;
       block = structure.parents[block]) {
    auto& original = state_->original[block];
    const auto begin = state_->values.begin() + static_cast<std::ptrdiff_t>(structure.value_starts[block]);
    const auto end = state_->values.begin() + static_cast<std::ptrdiff_t>(structure.value_starts[block + 1]);
    if (original.empty()) {
      original.assign(begin, end);
      state_->changed.push_back(block);
    }
    const std::uint32_t first = structure.first(block);
    const auto width = static_cast<std::uint32_t>(structure.width(block));
    const auto rows = structure.rows(block);
    const std::size_t height = structure.height(block);
    std::vector<double>& x = state_->column;
    x.assign(height, 0.0);
    std::size_t at = 0;
    for (const auto& [row, value] : w) {
      if (row < first + width) {
        x[row - first] = value;
        continue;
      }
      while (rows[at] != row) ++at;
      x[width + at] = value;
    }
    std::uint32_t k = 0;
    while (k < width && x[k] == 0) ++k;
    for (; k < width; ++k) {
      double* l = &*begin + k * height;
      const double pivot = l[k];
      const double changed = std::sqrt(pivot * pivot + sign * x[k] * x[k]);
      const double c = pivot / changed;
      const double s = sign * x[k] / changed;
      const double t = x[k] / changed;
      l[k] = changed;
      for (std::size_t i = k + 1; i < height; ++i) {
        const double old = l[i];
        l[i] = c * old + s * x[i];
        x[i] = c * x[i] - t * old;
      }
    }
    w.clear();
    for (std::size_t i = 0; i < rows.size(); ++i) w.emplace_back(rows[i], x[width + i]);
  }
}

void SparseFactor::reset() {
  for (const std::uint32_t block : state_->changed) {
    auto& original = state_->original[block];
    std::copy(original.begin(), original.end(),
              state_->values.begin() + static_cast<std::ptrdiff_t>(state_->structure->value_starts[block]));
    original.clear();
  }
  state_->changed.clear();
}

void SparseFactor::State::forward(std::size_t block, Eigen::Ref<VectorXd> x) const {
  const auto& [L, rows, first, width, below] = at(block);
  double* own = x.data() + first;
  thread_local VectorXd taken;
  taken.setZero(below);
  for (Index k = 0; k < width; ++k) {
    if (own[k] == 0) continue;
    own[k] /= L(k, k);
    Eigen::Map<VectorXd>(own + k + 1, width - k - 1) -= own[k] * L.col(k).segment(k + 1, width - k - 1);
    taken += own[k] * L.col(k).tail(below);
  }
  for (std::size_t i = 0; i < rows.size(); ++i) x[rows[i]] -= taken[static_cast<Index>(i)];
}

VectorXd SparseFactor::State::forward(std::span<const Entry> b) const {
  VectorXd x = VectorXd::Zero(static_cast<Index>(structure->order.size()));
  for (const auto& [vertex, value] : b) x[structure->new_place[vertex.index()]] += value;
  for (const std::uint32_t block : blocks_above(b, [](const Entry& entry) { return entry.vertex; })) forward(block, x);
  return x;
}

void SparseFactor::State::backward(std::size_t block, Eigen::Ref<VectorXd> x) const {
  const auto& [L, rows, first, width, below] = at(block);
  thread_local VectorXd known;
  known.resize(below);
  for (std::size_t i = 0; i < rows.size(); ++i) known[static_cast<Index>(i)] = x[rows[i]];
  double* own = x.data() + first;
  for (Index k = width; k-- > 0;) {
    const Index within = width - k - 1;
    const double sum = L.col(k).segment(k + 1, within).dot(Eigen::Map<VectorXd>(own + k + 1, within)) +
                       L.col(k).tail(below).dot(known);
    own[k] = (own[k] - sum) / L(k, k);
  }
}

void SparseFactor::State::backward_subtree(std::uint32_t block, Eigen::Ref<VectorXd>& x) const {
  backward(block, x);
  tbb::task_group group;
  for (const std::uint32_t child : structure->children[block]) {
    if (entries[child] > kTaskEntries) {
      group.run([this, child, &x] { backward_subtree(child, x); });
    } else {
      backward_subtree(child, x);
    }
  }
  group.wait();
}

void SparseFactor::State::backward(Eigen::Ref<VectorXd> x) const {
  tbb::task_group group;
  for (std::uint32_t b = 0; b < structure->blocks(); ++b)
    if (structure->parents[b] == BlockStructure::kRoot) group.run([this, b, &x] { backward_subtree(b, x); });
  group.wait();
}

void SparseFactor::solve(Eigen::Ref<MatrixXd> b) const {
  const BlockStructure& structure = *state_->structure;
  const auto n = static_cast<Index>(structure.order.size());
  const auto old = [&](Index i) { return static_cast<Index>(structure.order[static_cast<std::size_t>(i)]); };
  if (b.cols() == 1) {
    VectorXd x(n);
    for (Index i = 0; i < n; ++i) x[i] = b(old(i), 0);
    for (std::size_t block = 0; block < structure.blocks(); ++block) state_->forward(block, x);
    state_->backward(x);
    for (Index i = 0; i < n; ++i) b(old(i), 0) = x[i];
    return;
  }
  tbb::parallel_for(Index{0}, (b.cols() + 3) / 4, [&](Index group) {
    auto columns = b.middleCols(4 * group, std::min<Index>(4, b.cols() - 4 * group));
    std::vector<double> x(4 * structure.order.size(), 0.0);
    Eigen::Map<Eigen::Matrix<double, 4, Eigen::Dynamic>> by_row(x.data(), 4, n);
    for (Index k = 0; k < columns.cols(); ++k)
      for (Index i = 0; i < n; ++i) by_row(k, i) = columns(old(i), k);
    solve_four(structure, state_->values, x);
    for (Index k = 0; k < columns.cols(); ++k)
      for (Index i = 0; i < n; ++i) columns(old(i), k) = by_row(k, i);
  });
}

VectorXd SparseFactor::solve(std::span<const Entry> b) const {
  const BlockStructure& structure = *state_->structure;
  VectorXd x = state_->forward(b);
  state_->backward(x);
  VectorXd result(x.size());
  for (Index i = 0; i < x.size(); ++i) result[structure.order[static_cast<std::size_t>(i)]] = x[i];
  return result;
}

void SparseFactor::solve(std::span<const Entry> b, std::span<const VertexId> wanted, std::span<double> x) const {
  const BlockStructure& structure = *state_->structure;
  VectorXd y = state_->forward(b);
  const auto blocks = state_->blocks_above(wanted, [](VertexId vertex) { return vertex; });
  for (std::size_t i = blocks.size(); i-- > 0;) state_->backward(blocks[i], y);
  for (std::size_t i = 0; i < wanted.size(); ++i) x[i] = y[structure.new_place[wanted[i].index()]];
}

}  // namespace armature::sdk
