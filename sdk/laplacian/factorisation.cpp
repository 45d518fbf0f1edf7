#include "sdk/laplacian/factorisation.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <tbb/task_group.h>

namespace armature::sdk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Overwrites the first `width` columns of the lower triangle of a symmetric front with its factor, and the rest with
/// what is left of it. Returns whether all pivots were positive.
bool factor_front(Eigen::Ref<MatrixXd> front, Index width) {
  const Index below = front.rows() - width;
  constexpr Index kSmall = 24;
  if (width <= kSmall) {
    for (Index k = 0; k < width; ++k) {
      const double pivot = front(k, k);
      if (!(pivot > 0)) return false;
      const Index rest = front.rows() - k - 1;
      front(k, k) = std::sqrt(pivot);
      front.col(k).tail(rest) /= front(k, k);
      for (Index j = k + 1; j < width; ++j)
        front.col(j).tail(front.rows() - j) -= front(j, k) * front.col(k).tail(front.rows() - j);
    }
  } else {
    auto pivots = front.topLeftCorner(width, width);
    const Eigen::LLT<Eigen::Ref<MatrixXd>, Eigen::Lower> factor(pivots);
    if (factor.info() != Eigen::Success) return false;
    if (below > 0) {
      auto low = front.bottomLeftCorner(below, width);
      factor.matrixL().transpose().solveInPlace<Eigen::OnTheRight>(low);
    }
  }
  if (below > 0)
    front.bottomRightCorner(below, below)
        .selfadjointView<Eigen::Lower>()
        .rankUpdate(front.bottomLeftCorner(below, width), -1);
  return true;
}

class Factorisation {
 public:
  Factorisation(const Eigen::SparseMatrix<double>& matrix, const BlockStructure& structure,
                const std::vector<std::size_t>& entries, const Task& task, std::vector<double>& values)
      : matrix_(matrix),
        structure_(structure),
        task_(task),
        values_(values),
        left_(structure.blocks()),
        entries_(entries) {}

  std::uint32_t run() {
    tbb::task_group group;
    for (std::uint32_t b = 0; b < structure_.blocks(); ++b)
      if (structure_.parents[b] == BlockStructure::kRoot) {
        if (entries_[b] > kTaskEntries) {
          group.run([this, b] { subtree(b); });
        } else {
          subtree(b);
        }
      }
    group.wait();
    return failed_;
  }

 private:
  void subtree(std::uint32_t block) {
    tbb::task_group group;
    for (const std::uint32_t child : structure_.children[block]) {
      if (entries_[child] > kTaskEntries) {
        group.run([this, child] { subtree(child); });
      } else {
        subtree(child);
      }
    }
    group.wait();
    if (!task_.stopped() && failed_ == BlockStructure::kRoot) factor(block);
  }

  void factor(std::uint32_t block) {
    const std::uint32_t first = structure_.first(block);
    const auto width = static_cast<Index>(structure_.width(block));
    const auto height = static_cast<Index>(structure_.height(block));
    const auto rows = structure_.rows(block);
    const auto place_in_front = [&](std::uint32_t row) {
      if (row < first + width) return static_cast<Index>(row - first);
      return width + (std::lower_bound(rows.begin(), rows.end(), row) - rows.begin());
    };
    MatrixXd front = MatrixXd::Zero(height, height);
    for (Index k = 0; k < width; ++k)
      for (Eigen::SparseMatrix<double>::InnerIterator entry(matrix_,
                                                            structure_.order[first + static_cast<std::size_t>(k)]);
           entry; ++entry) {
        const std::uint32_t row = structure_.new_place[static_cast<std::size_t>(entry.row())];
        if (row >= first + k) front(place_in_front(row), k) = entry.value();
      }
    std::vector<Index> places;
    for (const std::uint32_t child : structure_.children[block]) {
      const auto child_rows = structure_.rows(child);
      places.clear();
      // Both ascend.
      std::size_t at = 0;
      for (const std::uint32_t row : child_rows) {
        if (row < first + width) {
          places.push_back(static_cast<Index>(row - first));
          continue;
        }
        while (rows[at] != row) ++at;
        places.push_back(width + static_cast<Index>(at));
      }
      const MatrixXd& left = left_[child];
      for (Index j = 0; j < left.cols(); ++j) {
        double* column = front.data() + places[static_cast<std::size_t>(j)] * height;
        for (Index i = j; i < left.rows(); ++i) column[places[static_cast<std::size_t>(i)]] += left(i, j);
      }
      left_[child] = MatrixXd();
    }
    if (!factor_front(front, width)) {
      std::uint32_t none = BlockStructure::kRoot;
      failed_.compare_exchange_strong(none, block);
      return;
    }
    Eigen::Map<MatrixXd>(values_.data() + structure_.value_starts[block], height, width) = front.leftCols(width);
    if (!rows.empty()) left_[block] = front.bottomRightCorner(height - width, height - width);
  }

  const Eigen::SparseMatrix<double>& matrix_;
  const BlockStructure& structure_;
  const Task& task_;
  std::vector<double>& values_;
  std::vector<MatrixXd> left_;
  const std::vector<std::size_t>& entries_;
  std::atomic<std::uint32_t> failed_ = BlockStructure::kRoot;
};

}  // namespace

std::vector<std::size_t> subtree_entries(const BlockStructure& structure) {
  std::vector<std::size_t> entries(structure.blocks());
  for (std::size_t b = 0; b < entries.size(); ++b) {
    entries[b] += structure.value_starts[b + 1] - structure.value_starts[b];
    if (structure.parents[b] != BlockStructure::kRoot) entries[structure.parents[b]] += entries[b];
  }
  return entries;
}

std::uint32_t factorise(const Eigen::SparseMatrix<double>& matrix, const BlockStructure& structure,
                        const std::vector<std::size_t>& entries, const Task& task, std::vector<double>& values) {
  return Factorisation(matrix, structure, entries, task, values).run();
}

}  // namespace armature::sdk
