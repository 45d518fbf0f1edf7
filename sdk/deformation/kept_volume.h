#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/deformation/skinning.h>
#include <armature/sdk/deformation/sphere_weights.h>
#include <armature/sdk/mesh/mesh.h>

#include "sdk/deformation/directed_vertex.h"

namespace armature::sdk {

/// Two triangles, a b c and a c d, by the numbers of their corners: their volumes are summed in half the time. One
/// alone is a b c a.
using Quad = std::array<std::uint32_t, 4>;

/// Gives a closed mesh the volume back that blended turns give or take (after von Funck, Theisel, Seidel 2008): where
/// turns disagree, the surface moves outward or inward, more where they disagree more and where spheres are larger, by
/// at most three quarters of their radius; what turns as a whole stays.
class KeptVolume {
 public:
  /// Of a mesh with these triangles.
  explicit KeptVolume(const Mesh& mesh);

  /// Whether there is a volume: each edge is walked as often one way as the other, so that the triangles enclose one
  /// wherever the origin is.
  [[nodiscard]] bool closed() const noexcept { return !quads_.empty(); }

  /// Where the mesh and the spheres lie, and what these weigh, while nothing has moved.
  void set_rest(const Mesh& mesh, const SkinWeights& weights, std::span<const Sphere> spheres);
  [[nodiscard]] bool has_rest() const noexcept { return !outward_.empty(); }
  void forget_rest() noexcept { outward_.clear(); }

  /// skin() by dual quaternions, and the volume. `rest` and `weights` are those of set_rest(); nothing is stretched.
  /// The same bits on any number of threads.
  void move(const SkinWeights& weights, std::span<const SphereMotion> motions, std::span<const Eigen::Vector3d> rest,
            std::span<Eigen::Vector3d> out);

 private:
  /// By how many directions vertices are to move, of which the longest is so much of the spheres' radius.
  [[nodiscard]] double share_of_directions(double most_of_radius) const;

  std::vector<Quad> quads_;              // none where there is a border
  std::vector<FourDirections> outward_;  // by four vertices: their normals, as long as the spheres there are wide
  double six_volumes_ = 0;               // at rest
  std::vector<DirectedVertex> moved_;    // before the volume is given back: kept for its room
};

}  // namespace armature::sdk
