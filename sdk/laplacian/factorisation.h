#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/SparseCore>
#include <armature/sdk/task.h>

#include "sdk/laplacian/block_structure.h"

namespace armature::sdk {

/// Subtrees with more entries than this are worth a task of their own.
inline constexpr std::size_t kTaskEntries = 1U << 16U;

/// How many entries lie in each block's subtree.
[[nodiscard]] std::vector<std::size_t> subtree_entries(const BlockStructure& structure);

/// Multifrontal factorisation (Duff and Reid 1983): every block takes what its children leave, factors its columns into
/// `values`, panel behind panel, and leaves the rest. Subtrees side by side, by their `entries`. Returns the first
/// block whose pivots are not all positive, or BlockStructure::kRoot. When the task is stopped, `values` are not
/// complete.
[[nodiscard]] std::uint32_t factorise(const Eigen::SparseMatrix<double>& matrix, const BlockStructure& structure,
                                      const std::vector<std::size_t>& entries, const Task& task,
                                      std::vector<double>& values);

}  // namespace armature::sdk
