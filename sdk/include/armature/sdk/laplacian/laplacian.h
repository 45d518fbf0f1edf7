#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <armature/sdk/mesh/adjacency.h>
#include <armature/sdk/mesh/mesh.h>

namespace armature::sdk {

/// The Laplacian of a surface, by finite elements.
struct Laplacian {
  /// [V][V], symmetric, both triangles stored, no length unit. Positive semi-definite: x' L x is the Dirichlet energy
  /// of x, so that L is minus the integrated Laplacian. Nothing off the diagonal is positive and rows sum to 0, hence a
  /// harmonic function lies between its boundary values. Zero for a vertex on no face; the diagonal is stored for all.
  Eigen::SparseMatrix<double> stiffness;
  /// [V], the lumped mass matrix's diagonal: a third of the areas at each vertex, in square length units.
  Eigen::VectorXd mass;
};

/// Cotangent weights on the intrinsic Delaunay triangulation of the mesh (Bobenko and Springborn 2007); of its tufted
/// cover where it has boundaries, non-manifold edges or faces that disagree on what is outside (Sharp and Crane 2020).
/// The same as the cotangents of the mesh itself where that is Delaunay, boundaries included. Takes any mesh: where
/// some faces have no area, all lengths grow by about a millionth of the mean edge; faces that name a vertex twice are
/// left out. Time linear in the mesh and the flips; the same on every run.
[[nodiscard]] Laplacian laplacian(const Mesh& mesh, const Adjacency& adjacency);

}  // namespace armature::sdk
