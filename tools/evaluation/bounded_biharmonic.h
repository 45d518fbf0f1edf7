#pragma once

#include <span>

#include <Eigen/Core>
#include <armature/sdk/laplacian/laplacian.h>
#include <armature/sdk/mesh/ids.h>

namespace armature::tools {

/// What one handle's bounded biharmonic weights took.
struct BoundedBiharmonic {
  Eigen::VectorXd weights;  ///< [V]
  int factorisations = 0;   ///< of a matrix of V rows, one a change of what is bound
};

/// Bounded biharmonic weights (Jacobson, Baran, Popovic, Sorkine 2011) of one handle on a surface, as libigl solves
/// them without a commercial solver, by an active set: w' L M^-1 L w is least with 1 at the handle, 0 at the others and
/// 0 <= w <= 1. A baseline for `armature bench deform`; nothing else uses it.
[[nodiscard]] BoundedBiharmonic bounded_biharmonic_weights(const sdk::Laplacian& laplacian,
                                                           std::span<const sdk::VertexId> handles, std::size_t handle);

}  // namespace armature::tools
