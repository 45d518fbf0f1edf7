#include "sdk/laplacian/block_structure.h"

#include <algorithm>
#include <utility>

namespace armature::sdk {

BlockStructure block_structure(const Eigen::SparseMatrix<double>& matrix, Dissection dissection) {
  BlockStructure result{.order = std::move(dissection.order), .starts = std::move(dissection.blocks)};
  const std::size_t n = result.order.size();
  const std::size_t blocks = result.starts.size() - 1;
  result.new_place.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) result.new_place[result.order[i]] = i;
  result.block_of.resize(n);
  for (std::uint32_t b = 0; b < blocks; ++b)
    for (std::uint32_t i = result.starts[b]; i < result.starts[b + 1]; ++i) result.block_of[i] = b;

  result.parents.assign(blocks, BlockStructure::kRoot);
  result.children.resize(blocks);
  result.row_starts.assign(1, 0);
  result.value_starts.assign(1, 0);
  std::vector<std::uint32_t> seen_by(n, BlockStructure::kRoot);
  std::vector<std::uint32_t> rows;
  for (std::uint32_t b = 0; b < blocks; ++b) {
    const std::uint32_t end = result.starts[b + 1];
    rows.clear();
    const auto add = [&](std::uint32_t row) {
      if (row < end || seen_by[row] == b) return;
      seen_by[row] = b;
      rows.push_back(row);
    };
    for (std::uint32_t i = result.starts[b]; i < end; ++i)
      for (Eigen::SparseMatrix<double>::InnerIterator entry(matrix, result.order[i]); entry; ++entry)
        add(result.new_place[static_cast<std::size_t>(entry.row())]);
    for (const std::uint32_t child : result.children[b])
      for (const std::uint32_t row : result.rows(child)) add(row);
    std::sort(rows.begin(), rows.end());
    if (!rows.empty()) {
      result.parents[b] = result.block_of[rows.front()];
      result.children[result.parents[b]].push_back(b);
    }
    result.row_ids.insert(result.row_ids.end(), rows.begin(), rows.end());
    result.row_starts.push_back(static_cast<std::uint32_t>(result.row_ids.size()));
    const std::size_t width = end - result.starts[b];
    result.value_starts.push_back(result.value_starts.back() + width * (width + rows.size()));
  }
  return result;
}

}  // namespace armature::sdk
