#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/error.h>
#include <armature/sdk/laplacian/laplacian.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// The lowest eigenpairs of a surface's Laplacian: L phi = lambda M phi.
struct Spectrum {
  Eigen::VectorXd values;     ///< [k], ascending, not negative; in one over square length units
  Eigen::MatrixXd functions;  ///< [V][k], a column each, orthonormal by mass; zero at vertices on no face
  /// [k]: |L phi - lambda M phi| over |phi|, in the norms of 1/M and M, over lambda + the mean value of all.
  Eigen::VectorXd residuals;
  std::size_t converged = 0;  ///< how many residuals are at most `SpectrumOptions::tolerance`
};

/// What is asked for.
struct SpectrumOptions {
  std::size_t count = 100;  ///< eigenpairs; as many as there are vertices with faces if that is less
  double tolerance = 1e-6;  ///< of a residual, to count as converged
  std::size_t most = 5;     ///< times as many directions, and 80 more, are tried before it ends with what has converged
};

/// Block Lanczos on the inverse of L + sigma M (Grimes, Lewis, Simon 1994), every direction made orthogonal to all
/// others by matrix products. Any mesh with a face. The same on every run and any number of threads. `residuals` tell
/// what has converged, which is everything unless `most` was too few. Fails for a mesh without faces.
[[nodiscard]] Expected<Spectrum> spectrum(const Mesh& mesh, const Laplacian& laplacian,
                                          const SpectrumOptions& options = {}, const Task& task = {});

}  // namespace armature::sdk
