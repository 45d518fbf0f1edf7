#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/error.h>
#include <armature/sdk/mesh/point_set.h>
#include <armature/sdk/selection/surface.h>

namespace armature::sdk {

/// What a brush says of the surface under it.
enum class Brush : std::uint8_t {
  Patch,       ///< belongs to the patch
  Background,  ///< does not
};

/// Selects a patch under a brush, live (thesis, section 5.3.3). What the brush touches is the patch; what lies farther
/// from it than two radii more is not; between them two floods compete, one from either side, each going first where
/// the surface bends least: a step from face to face costs the L2,1 metric's square of the difference of normals (Cohen
/// Steiner et al. 2004), less over a ridge than through a valley, where people cut (Hoffman and Richards 1984), and a
/// little for its length. Normals are means over about a sixth of the radius. The patch
/// hangs together: of several pieces, that with the largest brushed area counts. Refers to the surface, which must
/// outlive it. Thread-safe: no.
class PatchBrush {
 public:
  /// The radius of the brush, positive, in the mesh's unit.
  PatchBrush(const Surface& surface, double radius);

  /// Another radius from now on.
  void set_radius(double radius) noexcept { radius_ = radius; }
  /// Sets the brush down. The next point begins a stroke.
  void lift() noexcept { before_ = SurfacePoint(); }
  /// Draws on to a point of the surface; takes time in proportion to the faces within three radii. What is brushed
  /// last counts.
  void draw_to(const SurfacePoint& point, Brush brush = Brush::Patch);

  /// The faces of the patch, ascending; none before the first point. Takes time m log m in the m faces within three
  /// radii of the strokes.
  [[nodiscard]] std::vector<FaceId> faces() const;

 private:
  enum class Mark : std::uint8_t { Far, Near, Patch, Background };

  [[nodiscard]] std::vector<Eigen::Vector3d> smooth_normals() const;
  void straighten(std::vector<std::uint8_t>& owner) const;
  [[nodiscard]] std::vector<FaceId> largest_piece(const std::vector<std::uint8_t>& owner) const;

  const Surface* surface_;
  double radius_;
  SurfacePoint before_;
  std::vector<Mark> marks_;           // by face
  std::vector<FaceId> near_;          // all but the far ones, as they were reached
  std::vector<std::uint32_t> place_;  // in near_, by face
};

/// What is drawn to select a patch, in the mesh's unit.
struct PatchStrokes {
  std::vector<std::vector<Eigen::Vector3d>> strokes = {};     ///< points along each
  double radius = 0;                                          ///< of the brush
  std::vector<std::vector<Eigen::Vector3d>> background = {};  ///< strokes over what is no part of it, drawn afterwards
};

/// The patch of whole strokes, ascending. Refused, naming the stroke and the point: what `project_stroke()` refuses, no
/// stroke, strokes without a point, and a radius that is not positive.
[[nodiscard]] Expected<std::vector<FaceId>> select_patch(const Surface& surface, const PatchStrokes& drawn);

/// The same of points with normals, by what the brush touches alone: those within the radius of a stroke that face the
/// side which the closest point to it faces, without those that the background touches so. Ascending.
[[nodiscard]] Expected<std::vector<VertexId>> select_patch(const PointSet& points, const PatchStrokes& drawn);

}  // namespace armature::sdk
