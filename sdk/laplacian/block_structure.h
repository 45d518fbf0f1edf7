#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/SparseCore>

#include "sdk/laplacian/nested_dissection.h"

namespace armature::sdk {

/// Where a Cholesky factor has entries, in blocks of columns that share their rows (supernodes). Block b holds the
/// columns [first(b), first(b + 1)); each has a row for these and for rows(b).
struct BlockStructure {
  static constexpr std::uint32_t kRoot = 0xFFFF'FFFF;  ///< the parent of a block without one

  std::vector<std::uint32_t> order = {};                  ///< [n]: the old place of each new one
  std::vector<std::uint32_t> new_place = {};              ///< [n]: the new place of each old one
  std::vector<std::uint32_t> starts = {};                 ///< [blocks + 1], the first column of each
  std::vector<std::uint32_t> block_of = {};               ///< [n], by column
  std::vector<std::uint32_t> parents = {};                ///< [blocks]: the block of the first row below, or kRoot
  std::vector<std::vector<std::uint32_t>> children = {};  ///< [blocks], ascending
  std::vector<std::uint32_t> row_starts = {};             ///< [blocks + 1], in `row_ids`
  std::vector<std::uint32_t> row_ids = {};                ///< the rows below each block, ascending
  std::vector<std::size_t> value_starts = {};  ///< [blocks + 1]: where its panel begins, height by width, column-major

  [[nodiscard]] std::size_t blocks() const noexcept { return parents.size(); }
  [[nodiscard]] std::uint32_t first(std::size_t block) const noexcept { return starts[block]; }
  [[nodiscard]] std::size_t width(std::size_t block) const noexcept { return starts[block + 1] - starts[block]; }
  [[nodiscard]] std::span<const std::uint32_t> rows(std::size_t block) const noexcept {
    return std::span(row_ids).subspan(row_starts[block], row_starts[block + 1] - row_starts[block]);
  }
  [[nodiscard]] std::size_t height(std::size_t block) const noexcept { return width(block) + rows(block).size(); }
};

/// The structure of the factor of a symmetric matrix in the order of a dissection.
[[nodiscard]] BlockStructure block_structure(const Eigen::SparseMatrix<double>& matrix, Dissection dissection);

}  // namespace armature::sdk
