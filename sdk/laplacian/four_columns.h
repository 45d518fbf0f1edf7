#pragma once

#include <span>

#include "sdk/laplacian/block_structure.h"

namespace armature::sdk {

/// Solves L L' x = b for four right-hand sides side by side: `x`, [n][4] in the order of the factor, holds b and then
/// x. `values` are those of the factor, panel behind panel. Of each column the same bits as in any other company.
void solve_four(const BlockStructure& structure, std::span<const double> values, std::span<double> x);

}  // namespace armature::sdk
