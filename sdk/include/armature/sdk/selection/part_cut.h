#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/distance/mesh_tree.h>
#include <armature/sdk/error.h>
#include <armature/sdk/laplacian/sparse_factor.h>
#include <armature/sdk/mesh/ids.h>
#include <armature/sdk/selection/part_model.h>

namespace armature::sdk {

/// A part of a surface that is cut off by strokes along the cut (thesis, section 5.3.2, after Zheng and Tai 2010).
///
/// Each stroke point sets two constraints, one on either side of the stroke; the harmonic field between them has an
/// isoline that makes the best cut. Of its two sides the one that protrudes is the part, however the stroke was drawn;
/// but nothing of more than nine tenths of its component's area is one, so that a dent can be cut off, too.
/// More strokes refine the same cut. It holds a factor of its own, which follows every point. The model must outlive
/// it. Thread-safe: no.
class PartCut {
 public:
  /// No stroke yet. Copies the model's factor: a few milliseconds.
  explicit PartCut(const PartModel& model);

  /// Starts another stroke: the next point does not continue the last one.
  void begin_stroke();
  /// Continues the stroke to a point of the surface, as `project_stroke()` gives it. The way from the point before is
  /// projected onto the surface. What lies on another component than the first point of all is left out.
  void add_point(const SurfacePoint& point);
  /// Takes back the last point. A stroke without points is gone; false where there is none.
  bool undo_point();
  /// The other side of the cut is the part, and again the first one.
  void swap_sides();

  /// The part: faces ascending, linked by edges. Fails with what to do where no stroke was drawn or where the mesh is
  /// too coarse for the cut. Found when first asked for after a change.
  [[nodiscard]] Expected<std::vector<FaceId>> faces();
  /// The harmonic field by VertexId, in [0, 1]: high on the part (before sides are swapped); 0 on components without a
  /// stroke. Valid until the next change; empty without a stroke.
  [[nodiscard]] const Eigen::VectorXd& field();
  /// Along which value of the field the part is cut off. Valid as the field is.
  [[nodiscard]] double isovalue();

 private:
  struct Sample {
    SurfacePoint at;
    VertexId left;
    VertexId right;
  };
  struct Point {
    SurfacePoint at;
    std::size_t samples = 0;  // that it added
  };
  struct Stroke {
    std::vector<Point> points;
    std::vector<Sample> samples;
    double lean = 0;  // how much higher on its left the field of the strokes before it is
  };
  void add_sample(Stroke& stroke, const SurfacePoint& at, const Eigen::Vector3d& direction);
  void add_lone_point(Stroke& stroke);
  void remove_samples(Stroke& stroke, std::size_t count);
  void take_component();
  void solve();
  void choose_cut();

  const PartModel* model_;
  SparseFactor factor_;
  std::vector<Stroke> strokes_;
  std::uint32_t component_;
  std::vector<FaceId> component_faces_;
  std::vector<Eigen::Index> component_vertices_;
  bool swapped_ = false;
  bool solved_ = false;
  bool turned_ = false;  // so that the field is high on the part
  double weight_;
  Eigen::VectorXd field_;
  double isovalue_ = 0.5;
};

}  // namespace armature::sdk
