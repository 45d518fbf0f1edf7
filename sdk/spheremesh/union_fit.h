#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/distance/mesh_tree.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/spheremesh/sphere_mesh.h>
#include <armature/sdk/task.h>

#include "sdk/spheremesh/fit_samples.h"
#include "sdk/spheremesh/outer_space.h"

namespace armature::sdk {

/// What a distance costs: its size, rounded off near zero, and far out a power that grows past everything else.
struct FitLoss {
  double round = 1e-3;  ///< below this it is quadratic
  double far = 0.02;    ///< where the power takes over
  double tail = 0.5;    ///< its weight
  double power = 6;
  double outside = 1;  ///< how much more the union counts where it leaves the input
  double missing = 1;  ///< how much more it counts where it falls short of it

  /// `share` is what counts of the mean; the tail counts in full.
  [[nodiscard]] double cost(double distance, double share = 1) const noexcept;
  /// Of the square that touches the cost there: cost' / distance.
  [[nodiscard]] double weight(double distance, double share = 1) const noexcept;
  /// The factor for a signed distance, positive where the union is missing.
  [[nodiscard]] double side(double missing_by) const noexcept { return missing_by > 0 ? missing : outside; }
};

/// How far a union is from the input, in units of the input's bounding box diagonal; by samples, both ways.
struct FitError {
  double loss = 0;
  double forward = 0;  ///< mean distance from the input to the union
  double back = 0;     ///< and back
};

/// Fits the interpolated geometry of a sphere-mesh to a mesh in the unit frame, both directions, with its connectivity
/// as it is; and tells what a part of it costs.
class UnionFit {
 public:
  UnionFit(const Mesh& mesh, std::size_t samples);

  FitLoss loss;

  /// Points of the input: samples, and behind them the vertices that are watched.
  [[nodiscard]] const SurfaceSamples& samples() const noexcept { return samples_; }
  /// How many of them are samples.
  [[nodiscard]] std::size_t plain_count() const noexcept { return static_cast<std::size_t>(sample_count_); }
  [[nodiscard]] const MeshTree& tree() const noexcept { return tree_; }

  /// Samples of the union to an area of its surface.
  [[nodiscard]] double density() const noexcept { return density_; }

  /// Looks at every vertex of the input and watches those that are farthest from the union from now on: the tail of
  /// their distances counts. Samples miss what is thin. Returns the largest distance.
  double watch_far_vertices(const UnionGauge& gauge);

  [[nodiscard]] FitError error(const UnionGauge& gauge, const OuterSpace& outer) const;
  /// Gauss-Newton with Levenberg and Marquardt's damping on all centres and radii but the fixed ones, each at least 0.
  /// Never makes the loss larger. Returns early if it no longer falls, or the task is stopped. The outer space follows.
  void improve(SphereMesh& shape, OuterSpace& outer, int iterations, const std::vector<bool>& fixed,
               const Task& task) const;

  /// The share of the loss that point k of the input has at this distance from the union.
  [[nodiscard]] double forward_cost(std::size_t k, double distance) const noexcept {
    return loss.side(distance) * loss.cost(distance, plain_[k]) / sample_count_;
  }
  [[nodiscard]] double forward_weight(std::size_t k, double distance) const noexcept {
    return loss.side(distance) * loss.weight(distance, plain_[k]) / sample_count_;
  }
  /// The share of the loss that the boundary on these pieces has, by `thin` times fewer samples.
  [[nodiscard]] double back_cost(const UnionGauge& gauge, const OuterSpace& outer, const PieceFilter& pieces,
                                 double thin = 1) const;
  /// That of every piece, as UnionTouch names them.
  [[nodiscard]] std::vector<double> back_costs(const UnionGauge& gauge, const OuterSpace& outer) const;

 private:
  /// A residual: how far the point of the union with these weights must move along `direction`.
  struct Row {
    double residual;
    double weight;  ///< 0: none
    double cost;
    double share;  ///< of a sample's area; 0 to 1
    Corners corners{};
    std::array<double, 3> weights{};
    Eigen::Vector4d gradient;  ///< of the residual's distance by centre and radius of the interpolated sphere
  };
  class NormalEquations;
  /// A whole union, where one is at hand: it tells narrow clefts from cavities.
  struct Whole {
    const UnionGauge& gauge;
    NearbyPieces pieces;
  };

  [[nodiscard]] std::vector<Row> rows(const UnionGauge& gauge, const OuterSpace& outer, FitError& error) const;
  void forward_rows(const UnionGauge& gauge, std::vector<Row>& rows) const;
  void back_rows(const UnionGauge& gauge, const OuterSpace& outer, std::vector<Row>& rows) const;
  /// No weight where the sample lies on the wall of a cavity.
  [[nodiscard]] Row back_row(const UnionSample& sample, const OuterSpace& outer, FaceId& hint,
                             const Whole* whole = nullptr) const;

  SurfaceSamples samples_;
  std::vector<double> plain_;  ///< by sample: 1, or 0 for a watched vertex, of which only the tail counts
  double sample_count_ = 1;    ///< without the watched vertices
  std::vector<Eigen::Vector3d> vertices_, vertex_normals_;  ///< of the input, near ones together
  MeshTree tree_;
  std::vector<Eigen::Vector3d> face_normals_;
  double density_ = 0;
};

}  // namespace armature::sdk
