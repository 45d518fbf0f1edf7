#pragma once

#include <vector>

#include <armature/sdk/error.h>
#include <armature/sdk/mesh/adjacency.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// How strongly a surface bends along its two principal directions, in 1 / length unit. Positive where the shape is
/// convex: 1/r and 1/r on a sphere of radius r whose normals point outward, 1/r and 0 on a cylinder.
struct PrincipalCurvatures {
  double k1 = 0;  ///< the larger one
  double k2 = 0;  ///< the smaller one
};

/// Estimates the principal curvatures at every vertex, by VertexId, from the quadratic height field that fits its one-
/// and two-ring best (Petitjean 2002, section 4), with its slope. Their magnitudes are at most 1 / (mean length of the
/// edges at the vertex), about what the mesh can resolve. Finite everywhere; 0 where no face is or nothing can be told.
/// Uses all cores; the same on any number of them.
[[nodiscard]] Expected<std::vector<PrincipalCurvatures>> principal_curvatures(const Mesh& mesh,
                                                                              const Adjacency& adjacency,
                                                                              const Task& task = {});

/// How much every vertex matters for the abstraction of a shape, by VertexId: K = 1 + sigma BBD^2 (k1^2 + k2^2), with
/// BBD the diagonal of the bounding box (thesis, section 4.6.6). `sigma` is not negative; 0 makes all ones, at once.
[[nodiscard]] Expected<std::vector<double>> curvature_importance(const Mesh& mesh, double sigma, const Task& task = {});

}  // namespace armature::sdk
