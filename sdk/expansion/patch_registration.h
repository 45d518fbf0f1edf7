#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/expansion/patch_map.h>
#include <armature/sdk/selection/surface.h>

#include "sdk/expansion/face_graph.h"
#include "sdk/expansion/polar_relief.h"
#include "sdk/expansion/region_shares.h"
#include "sdk/expansion/sample_grid.h"
#include "sdk/expansion/surface_samples.h"

namespace armature::sdk {

/// Where a similarity takes a point.
[[nodiscard]] inline Eigen::Vector3d apply(const Eigen::Matrix4d& T, const Eigen::Vector3d& point) {
  return T.topLeftCorner<3, 3>() * point + T.topRightCorner<3, 1>();
}

/// A few hundred samples of a surface within `radius` of a vertex, and as densely within `reach`, of what hangs
/// together with it. Their normals are means of those at the corners of their faces, which noise turns less.
[[nodiscard]] std::vector<SurfaceSample> samples_about(const FaceGraph& graph, VertexId at, double radius,
                                                       double reach);

/// What is near a place of a surface and hangs together with it.
struct PatchSurroundings {
  Eigen::Vector3d centre;
  std::vector<SurfaceSample> samples;  ///< a few hundred
  PolarRelief relief;

  /// Samples within `reach`, the relief within `radius`.
  PatchSurroundings(const FaceGraph& graph, VertexId at, double radius, double reach);
};

/// Where a patch lies on a surface.
struct PatchFit {
  Eigen::Matrix4d target_from_reference = Eigen::Matrix4d::Identity();
  double scale = 1;              ///< of that
  bool mirrored = false;         ///< whether it mirrors
  double fit = 0;                ///< how well the surfaces lie on one another, in [0, 1]
  bool turns_as_well = false;    ///< whether it fits nearly as well turned otherwise
  bool mirrors_as_well = false;  ///< whether it fits nearly as well with the other handedness
};

/// The middle of samples within a radius of a centre, by area, and the axes of their second moments, columns.
struct PatchMoments {
  Eigen::Vector3d middle;
  Eigen::Matrix3d axes;
};

/// How hard a way to lie is improved.
struct Effort {
  std::size_t samples;  ///< about so many
  int rounds;           ///< at most
  bool sized = true;    ///< whether the scale may change
  double apart = 0.05;  ///< so far apart is as bad as nothing there, of the radius
};

/// Where a surface comes nearest to a point: downhill from the face that was last nearest, if any; and where that is
/// not near, of a patch of that radius, from what its grid knows near the point, since it may be another fold. No valid
/// face where neither knows one.
[[nodiscard]] SurfacePoint closest_near(const FaceGraph& graph, const SampleGrid& grid, FaceId last,
                                        const Eigen::Vector3d& point, double radius);

/// The border of a patch, as a mesh of faces that are edges.
[[nodiscard]] Mesh border_of(const Surface& surface, std::span<const FaceId> patch);

/// The reference of an expansion, ready to be laid onto other places.
class PatchReference {
 public:
  PatchReference(const FaceGraph& graph, std::span<const FaceId> patch, const PatchBall& ball);

  /// Lays the reference onto the surface of a graph about a vertex at about a scale, as it is and mirrored: from the
  /// angles at which the reliefs agree and from the axes of second moments, by iterated closest points to the tangent
  /// plane (Chen and Medioni 1991), on a grid; those that fit best, and their images where the reference is nearly its
  /// own, on the surface itself, until it is decided which fits best.
  [[nodiscard]] PatchFit lay(const FaceGraph& graph, VertexId at, double scale, bool mirrored_too) const;
  /// The faces of that surface that come to lie on the patch; those that hang together in the largest piece.
  [[nodiscard]] std::vector<FaceId> extent(const FaceGraph& graph, const PatchFit& laid) const;

  [[nodiscard]] const PatchBall& ball() const noexcept { return ball_; }
  [[nodiscard]] const Eigen::Vector3d& centre() const noexcept { return around_.centre; }

 private:
  /// The best of some ways, improved on the surface itself.
  [[nodiscard]] PatchFit best_of(std::vector<PatchFit> ways, const FaceGraph& graph, const SampleGrid& grid,
                                 double scale) const;
  /// Improves a way to lie. `find(i, point)` gives the target near the i-th sample, which has come to lie there, or
  /// nothing.
  template <class Find>
  void improve(PatchFit& way, double scale, const Effort& effort, Find&& find) const;
  /// What finds targets on the surface of a graph, at about a scale.
  [[nodiscard]] auto on_surface(const FaceGraph& graph, const SampleGrid& grid, double scale) const;

  void find_images();
  void measure_border(const FaceGraph& graph);

  const FaceGraph* graph_;
  const Surface* surface_;
  PatchBall ball_;
  double area_;  // of the patch
  PatchSurroundings around_;
  PatchMoments moments_;
  SampleGrid grid_;
  RegionShares shares_;           // of the patch
  std::vector<float> to_border_;  // by vertex; negative far from the patch
  MeshTree border_;               // of the patch
  std::vector<PatchFit> images_;  // how else it lies on itself so well that noise might take one for the other
};

}  // namespace armature::sdk
