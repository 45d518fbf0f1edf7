#pragma once

#include <span>
#include <vector>

#include <armature/sdk/error.h>
#include <armature/sdk/laplacian/laplacian.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/mesh/point_set.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// What becomes of a similarity before it weighs an edit (thesis, section 5.6.2): 0 up to `from`, 1 from `to` on,
/// smooth in between.
struct Transfer {
  double from = 0;  ///< below `to`
  double to = 1;    ///< above `from`

  /// The weight of a similarity.
  [[nodiscard]] double operator()(double similarity) const noexcept;
};

/// The weights of a similarity map, [V], in [0, 1].
[[nodiscard]] std::vector<double> edit_weights(std::span<const float> similarity, const Transfer& transfer = {});

/// Edits of vertices, each by its weight: `weights` are [V], in [0, 1], and 0 leaves a vertex where it is. Refused
/// where there is not one weight a vertex. Faces stay; vertices without a normal do not move along it.

/// p + w d n.
[[nodiscard]] Expected<Mesh> displaced(const Mesh& mesh, std::span<const double> weights, double distance);
/// The same of points.
[[nodiscard]] Expected<PointSet> displaced(const PointSet& points, std::span<const double> weights, double distance);
/// Implicit smoothing over about `length`, in the model's unit: (M S^-1 + length^2 L) p' = M S^-1 p with the weights as
/// S (after Desbrun, Meyer, Schroeder, Barr 1999); vertices of weight below 0.001 are held. Stable for any length.
[[nodiscard]] Expected<Mesh> smoothed(const Mesh& mesh, const Laplacian& laplacian, std::span<const double> weights,
                                      double length, const Task& task = {});
/// What smoothing over `length` takes away is added instead, `amount` times.
[[nodiscard]] Expected<Mesh> sharpened(const Mesh& mesh, const Laplacian& laplacian, std::span<const double> weights,
                                       double length, double amount, const Task& task = {});
/// The pale grey that a mesh without colours has before it is painted.
inline constexpr Colour kPlainColour = {214, 214, 210};
/// Colours mixed in by weight; more than 1 is 1, less than 0 is 0.
[[nodiscard]] Expected<Mesh> painted(const Mesh& mesh, std::span<const double> weights, const Colour& colour);
/// The same of points.
[[nodiscard]] Expected<PointSet> painted(const PointSet& points, std::span<const double> weights, const Colour& colour);

}  // namespace armature::sdk
