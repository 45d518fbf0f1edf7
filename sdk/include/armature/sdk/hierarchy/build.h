#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <armature/sdk/error.h>
#include <armature/sdk/hierarchy/hierarchy.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/mesh/point_set.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// A vertex whose sphere the user has decided. Collapses draw others into it and leave it as it is; two of them are
/// never joined.
struct PinnedSphere {
  VertexId vertex;                    ///< of the mesh; its sphere is in every level
  std::optional<Sphere> sphere = {};  ///< in the model's coordinates; the vertex itself if it is left out
};

/// How a mesh is decimated (thesis, sections 4.4 to 4.6).
struct HierarchyOptions {
  /// sigma of section 4.6.6: how much more curved places count. 0 fits, 1 (the thesis's) abstracts.
  double importance = 0;
  /// Weights by vertex instead of `importance`: positive. Empty, or one a vertex.
  std::vector<double> weights = {};
  /// The integral over the region of so much times |q - x|^2 is added to its error, in units of the bounding box's
  /// diagonal: it decides where the planes leave a sphere free to slide. 0 is the thesis's method.
  double regularise = 1e-4;
  /// How much the distances of a region's points from its sphere count in the rank of a collapse, beside those of its
  /// planes, squared. The planes of a straight tube touch a sphere within it wherever that is, so that they alone cut
  /// it along, into staves whose spheres all lie at its middle: 0.01 cuts it across, as bends want it. It changes the
  /// order of collapses, not the spheres of regions. Nothing: 0, or 0.01 where a tenth of the mesh would else be staves
  /// at the level of 20 spheres; such a mesh is decimated twice. To see that, decimation goes on to this level, if
  /// `stop_at` is more, and what is beyond is dropped: up to twice the time. It is 0 without a look where the mesh has
  /// fewer than 200 vertices, `stop_at` is more than a tenth of them or more than 20 spheres are pinned, and 0 where
  /// topology or labels end the hierarchy before 20.
  std::optional<double> compactness = std::nullopt;
  /// Collapses are ranked by how much they add to the error of all regions, the sum that is to be small (equation 4.3);
  /// else, as in the thesis, by the error of the region that they make.
  bool by_increase = true;
  /// A sphere's radius is at most so many times the smallest extent of its region (section 4.6.3). The cap of a ball
  /// is narrower than the ball: the thesis's 3/4 cuts its radius short up to 109 degrees from its pole, 1.2 up to 80.
  double radius_per_width = 1.2;
  /// The directions in which regions are measured for the bound of their radius (section 4.6.3) are taken about the
  /// principal axes of the surface, so that the result does not depend on how the model is turned; else, as in the
  /// thesis, about the model's axes.
  bool own_frame = true;
  /// Vertices nearer than so much of the bounding box's diagonal may be joined through the solid, although no edge
  /// joins them (section 4.6.5). 0: none. Not with `keep_topology`.
  double enrichment = 0;
  /// Collapses that turn a triangle over come last.
  bool penalise_flips = true;
  /// Only collapses that keep the topology of the complex; the hierarchy ends where there are none left.
  bool keep_topology = false;
  /// A painted label by vertex; vertices with different labels are never joined. Empty, or one a vertex.
  std::vector<std::uint32_t> labels = {};
  std::vector<PinnedSphere> pinned = {};  ///< each vertex once
  /// The coarsest level that is wanted.
  std::size_t stop_at = 1;

  /// The settings of the thesis's results.
  [[nodiscard]] static HierarchyOptions paper() {
    return {.importance = 1,
            .regularise = 0,
            .compactness = 0,
            .by_increase = false,
            .radius_per_width = 0.75,
            .own_frame = false};
  }
};

/// What a build took.
struct BuildStatistics {
  double init_ms = 0;         ///< topology, quadrics, the first queue
  double decimate_ms = 0;     ///< all collapses, those that were dropped again included
  std::size_t collapses = 0;  ///< pairs of spheres joined
  double compactness = 0;     ///< that of the options, or what was found
};

/// A hierarchy and what it took.
struct HierarchyBuild {
  Hierarchy hierarchy;         ///< every level
  BuildStatistics statistics;  ///< what it took
};

/// Decimates a mesh by the spherical quadric error down to one sphere a component, then joins the components by the
/// same measure until one is left: the complete hierarchy, unless `stop_at`, `keep_topology`, labels or pins end it
/// before. Any mesh will do: non-manifold, open, degenerate, inside out (for the computation a component of negative
/// volume is turned over together with what lies within it, unless it is itself within another). A vertex on no
/// triangle is a sphere of radius 0. Deterministic. The task is told of the stages "decimating" and, where
/// `compactness` is left out, "looking for staves" and "decimating across". Fails for options out of range and meshes
/// without vertices.
[[nodiscard]] Expected<HierarchyBuild> build_hierarchy(const Mesh& mesh, const HierarchyOptions& options = {},
                                                       const Task& task = {});

/// The same of points with normals. Each stands for a flat disc of its area (estimated from its neighbours where the
/// set has none) instead of a vertex's cell; what is collapsed are edges between neighbours, and the triangles that
/// these make, in the tangent plane, are the level's. The hierarchy's leaves are the points. Points without a normal
/// weigh nothing. The task is also told of "joining points". Refused as well: points without any normal or that
/// `validate()` refuses, so far apart or so close that squares of their distances are no numbers, areas that are
/// together 0 or 1e12 times off the square of their box's diagonal, `importance` without `weights`, and
/// `keep_topology`.
[[nodiscard]] Expected<HierarchyBuild> build_hierarchy(const PointSet& points, const HierarchyOptions& options = {},
                                                       const Task& task = {});

}  // namespace armature::sdk
