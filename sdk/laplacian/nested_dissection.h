#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// An order in which a sparse symmetric matrix keeps sparse when it is factored, with the blocks of columns that are
/// factored together.
struct Dissection {
  std::vector<std::uint32_t> order = {};   ///< [n]: the old place of each new one
  std::vector<std::uint32_t> blocks = {};  ///< where each block of columns begins, in new places; then n
};

/// Cuts the graph of a matrix in two again and again by few vertices, which come last (George 1973). A cut is the
/// narrowest among those across the axes near the middle. `positions` places every row; where they fall together cuts
/// are worse, nothing else. Uses all cores; the same on any number of them. Of no use where `task` was stopped
/// meanwhile.
[[nodiscard]] Dissection nested_dissection(const Eigen::SparseMatrix<double>& matrix,
                                           std::span<const Eigen::Vector3d> positions, const Task& task = {});

}  // namespace armature::sdk
