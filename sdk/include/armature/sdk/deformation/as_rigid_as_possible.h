#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/error.h>
#include <armature/sdk/laplacian/laplacian.h>
#include <armature/sdk/laplacian/sparse_factor.h>
#include <armature/sdk/mesh/ids.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// A surface of which some vertices are free and follow the others as rigidly as they can (Sorkine and Alexa 2007):
/// sum over i and j of w_ij |y_i - y_j - R_i (x_i - x_j)|^2 is least, with the weights of the Laplacian. Only what is
/// free is factored and solved for. Thread-safe to read.
class AsRigidAsPossible {
 public:
  /// `rest`, [V], is the shape that is kept; `is_free`, [V]. Free vertices that hang together with no other stay where
  /// `solve()` finds them.
  [[nodiscard]] static Expected<AsRigidAsPossible> of(const Laplacian& laplacian, std::span<const Eigen::Vector3d> rest,
                                                      const std::vector<bool>& is_free, const Task& task = {});

  /// Improves `positions`, [V], from where they are: that many times turns are fitted and free vertices solved for.
  /// Others stay.
  void solve(std::span<Eigen::Vector3d> positions, int rounds = 8) const;

 private:
  struct Edge {
    std::uint32_t to;      // local
    double weight;         // w_ij
    Eigen::Vector3d rest;  // x_i - x_j
  };
  explicit AsRigidAsPossible(SparseFactor factor) : factor_(std::move(factor)) {}

  SparseFactor factor_;                // of the free vertices, which come first
  std::vector<VertexId> vertices_;     // by local number: those that are free, then their neighbours
  std::vector<std::uint32_t> starts_;  // by local number, in edges_
  std::vector<Edge> edges_;            // of neighbours, those to other local vertices
};

}  // namespace armature::sdk
