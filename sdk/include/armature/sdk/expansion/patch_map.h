#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <armature/sdk/error.h>
#include <armature/sdk/expansion/histogram.h>
#include <armature/sdk/mesh/ids.h>
#include <armature/sdk/selection/surface.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// Where a patch lies and how far it reaches.
struct PatchBall {
  VertexId centre;    ///< the vertex of the patch in front of the centre of the smallest ball around it: where it faces
  double radius = 0;  ///< from there to its farthest vertex, in the mesh's unit
};

/// The ball of a patch. Refused for no faces, faces that are not there, and patches of one point.
[[nodiscard]] Expected<PatchBall> patch_ball(const Surface& surface, std::span<const FaceId> patch);

/// What every vertex of a surface sees around it: the patch shape context (thesis, section 5.4.3 and algorithm 3),
/// which is how the area within a radius of it spreads over 10 x 10 bins, min(9, floor(10 d / radius)) of the distance
/// and min(9, floor(10 alpha / pi)) of the angle between the normal there and its own. Normals are means over a tenth
/// of the radius, so that noise finer than that and the triangles matter little. Refers to the surface, which must
/// outlive it. Thread-safe to read; uses all cores; the same on any number of them.
class PatchContexts {
 public:
  static constexpr std::size_t kDistances = 10;  ///< bins of distance, the rows
  static constexpr std::size_t kAngles = 10;     ///< bins of angle, the columns

  /// Takes time n log n. `radius` is positive, in the mesh's unit.
  [[nodiscard]] static Expected<PatchContexts> build(const Surface& surface, double radius, const Task& task = {});
  ~PatchContexts();
  PatchContexts(PatchContexts&&) noexcept;
  PatchContexts& operator=(PatchContexts&&) noexcept;

  /// The context of a vertex; zeros for one on no face.
  [[nodiscard]] Histogram of(VertexId vertex) const;
  /// The contexts of all vertices, [V][kDistances][kAngles].
  [[nodiscard]] Expected<std::vector<float>> of_all(const Task& task = {}) const;
  /// The similarity map: 1 - chi-square between every vertex's context and another, by VertexId, in [0, 1]; 0 for a
  /// vertex on no face. Before that every bin is spread over its neighbours by 1/4, 1/2, 1/4 in either direction, since
  /// noise carries points over the edges of bins. Takes time in proportion to the vertices in all balls. Refused for a
  /// context that is not of kDistances x kAngles bins.
  [[nodiscard]] Expected<std::vector<float>> similarity_to(std::span<const float> context, const Task& task = {}) const;

 private:
  struct State;
  explicit PatchContexts(std::unique_ptr<const State> state);
  std::unique_ptr<const State> state_;
};

}  // namespace armature::sdk
