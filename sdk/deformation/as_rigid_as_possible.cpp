#include <utility>

#include <armature/sdk/deformation/as_rigid_as_possible.h>
#include <tbb/parallel_for.h>

#include "sdk/deformation/best_turn.h"

namespace armature::sdk {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

Expected<AsRigidAsPossible> AsRigidAsPossible::of(const Laplacian& laplacian, std::span<const Vector3d> rest,
                                                  const std::vector<bool>& is_free, const Task& task) {
  const auto& L = laplacian.stiffness;
  constexpr std::uint32_t kNone = 0xFFFF'FFFF;
  std::vector<std::uint32_t> local(rest.size(), kNone);
  std::vector<VertexId> vertices;
  for (std::size_t v = 0; v < rest.size(); ++v)
    if (is_free[v]) {
      local[v] = static_cast<std::uint32_t>(vertices.size());
      vertices.emplace_back(v);
    }
  const std::size_t free = vertices.size();
  std::vector<Vector3d> free_positions;
  std::vector<Eigen::Triplet<double>> entries;
  // Holds pieces that nothing else holds, and is felt by no other.
  constexpr double kHold = 1e-9;
  for (std::size_t i = 0; i < free; ++i) {
    free_positions.push_back(rest[vertices[i].index()]);
    double most = 0;
    for (Eigen::SparseMatrix<double>::InnerIterator entry(L, static_cast<Index>(vertices[i].index())); entry; ++entry) {
      const auto row = static_cast<std::size_t>(entry.row());
      if (local[row] == kNone) {
        local[row] = static_cast<std::uint32_t>(vertices.size());
        vertices.emplace_back(row);
      }
      if (local[row] < free) entries.emplace_back(static_cast<int>(local[row]), static_cast<int>(i), entry.value());
      most = std::max(most, entry.value());
    }
    entries.emplace_back(static_cast<int>(i), static_cast<int>(i), most > 0 ? kHold * most : 1.0);
  }
  Eigen::SparseMatrix<double> A(static_cast<Index>(free), static_cast<Index>(free));
  A.setFromTriplets(entries.begin(), entries.end());
  auto factor = SparseFactor::of(A, free_positions, task);
  if (!factor) return tl::unexpected(factor.error());
  AsRigidAsPossible surface(std::move(*factor));
  surface.starts_.push_back(0);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const std::size_t v = vertices[i].index();
    for (Eigen::SparseMatrix<double>::InnerIterator entry(L, static_cast<Index>(v)); entry; ++entry) {
      const auto row = static_cast<std::size_t>(entry.row());
      if (row != v && local[row] != kNone) surface.edges_.push_back({local[row], -entry.value(), rest[v] - rest[row]});
    }
    surface.starts_.push_back(static_cast<std::uint32_t>(surface.edges_.size()));
  }
  surface.vertices_ = std::move(vertices);
  return surface;
}

void AsRigidAsPossible::solve(std::span<Vector3d> positions, int rounds) const {
  const std::size_t free = factor_.size();
  std::vector<Matrix3d> turns(vertices_.size());
  Eigen::MatrixXd change(static_cast<Index>(free), 3);
  const auto edges_of = [&](std::size_t i) {
    return std::span(edges_).subspan(starts_[i], starts_[i + 1] - starts_[i]);
  };
  for (int round = 0; round < rounds; ++round) {
    tbb::parallel_for(std::size_t{0}, vertices_.size(), [&](std::size_t i) {
      Matrix3d S = Matrix3d::Zero();
      for (const auto& [to, weight, rest] : edges_of(i))
        S += weight * (positions[vertices_[i].index()] - positions[vertices_[to].index()]) * rest.transpose();
      turns[i] = best_turn(S);
    });
    // The step from where they are: what is left of the force on each.
    for (std::size_t i = 0; i < free; ++i) {
      Vector3d force = Vector3d::Zero();
      for (const auto& [to, weight, rest] : edges_of(i))
        force += weight * (0.5 * (turns[i] + turns[to]) * rest -
                           (positions[vertices_[i].index()] - positions[vertices_[to].index()]));
      change.row(static_cast<Index>(i)) = force.transpose();
    }
    factor_.solve(change);
    for (std::size_t i = 0; i < free; ++i)
      positions[vertices_[i].index()] += change.row(static_cast<Index>(i)).transpose();
  }
}

}  // namespace armature::sdk
