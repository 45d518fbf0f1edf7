#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/expansion/expansion.h>
#include <armature/sdk/mesh/mesh.h>

namespace armature::tools {

/// A region that is known to be like a reference.
struct PlantedCopy {
  std::vector<sdk::FaceId> faces = {};  ///< ascending
  Eigen::Matrix4d reference_from_copy = Eigen::Matrix4d::Identity();
  bool mirrored = false;
};

/// A mesh in which the likes of a region are known.
struct PlantedScene {
  sdk::Mesh mesh = {};
  std::vector<sdk::FaceId> reference = {};  ///< ascending
  std::vector<PlantedCopy> copies = {};     ///< without the reference
  /// What is like it, too, though no copy, as fingers are: a match there is neither right nor wrong. Each ascending.
  std::vector<std::vector<sdk::FaceId>> others_alike = {};
  bool turns_known = true;  ///< of the copies
};

/// What is planted.
struct PlantOptions {
  std::size_t copies = 8;
  double largest_scale = 1;  ///< copies are up to so many times as large, or as small, as the reference
  bool mirrored = false;     ///< every other copy is a mirror image
  double bend_rad = 0;       ///< copies of models are bent along their longest side, by up to it from end to end
  double noise_percent =
      0;  ///< of the diagonal of the ball's, or a model's, bounding box: every vertex moves by up to it
  std::uint32_t seed = 1;
};

/// One shape of relief, without any symmetry, at random places and turns of a ball; between them three times as many of
/// other shapes. The ball is an icosahedron whose faces are cut into four `rounds` times.
[[nodiscard]] PlantedScene planted_reliefs(const PlantOptions& options, int rounds);

/// A model and turned copies of it beside one another; a region of it is the reference. The same triangles in the same
/// order for each.
[[nodiscard]] PlantedScene planted_models(const sdk::Mesh& model, std::span<const sdk::FaceId> region,
                                          const PlantOptions& options);

/// Copies of a blob with arms as components of their own, and beside each a ball, a hollow ball and half a blob.
[[nodiscard]] PlantedScene planted_components(const PlantOptions& options, int rounds);

/// The faces within `radius` of a vertex that hang together with it, ascending: for want of a brush.
[[nodiscard]] std::vector<sdk::FaceId> region_about(const sdk::Mesh& mesh, sdk::VertexId vertex, double radius);
/// The vertex that lies farthest from the middle of the bounding box.
[[nodiscard]] sdk::VertexId farthest_vertex(const sdk::Mesh& mesh);

/// Area of the intersection over that of the union of two sets of faces, ascending; `areas` by FaceId.
[[nodiscard]] double overlap_of(std::span<const double> areas, std::span<const sdk::FaceId> a,
                                std::span<const sdk::FaceId> b);

/// How well an expansion finds what was planted. Of the first k matches, k being how many copies there are; those of
/// what is alike, too, are left out before.
struct PlantedQuality {
  double precision = 0;  ///< matches that share more than half with a copy, of k
  double recall = 0;     ///< copies that such a match shares with, of all
  double overlap = 0;    ///< area of intersection over union, mean of those matches
  double flipped = 0;  ///< those turned by more than 45 degrees against the truth or wrongly mirrored, of those matches
};
[[nodiscard]] PlantedQuality quality_of(const PlantedScene& scene, const sdk::Expansion& expansion);

}  // namespace armature::tools
