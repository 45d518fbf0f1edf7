#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include <armature/sdk/descriptors/descriptor.h>
#include <armature/sdk/editing/vertex_edits.h>
#include <armature/sdk/expansion/expansion.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/spheremesh/primitives.h>

namespace armature::viewer {

class MeshShape;
struct SphereShape;

/// By what vertices are compared: growing least squares, heat and wave kernel signatures, patch shape contexts.
enum class Likeness : std::uint8_t { Gls, Hks, Wks, Psc };
enum class EditOp : std::uint8_t { Displace, Smooth, Sharpen, Paint, Pull, Copy, Alike };

///@{
/// How scripts spell them, in the order of the enumerations.
inline const std::vector<std::string_view> kLikenesses = {"gls", "hks", "wks", "psc"};
inline const std::vector<std::string_view> kEditOps = {"displace", "smooth", "sharpen", "paint",
                                                       "pull",     "copy",   "alike"};
///@}

/// What is done to a mesh where it is like something.
struct Edit {
  EditOp op = EditOp::Displace;
  /// A part of the diagonal of the bounding box to displace, pull and smooth by; a factor to sharpen and make alike by;
  /// a strength to paint with.
  double amount = 0;
  bool regions = false;  ///< each region in its place; else every vertex by its similarity
};

/// Where it is done.
struct EditPlaces {
  std::vector<float> similarity = {};  ///< [V], for edits of vertices,
  sdk::Transfer transfer = {};         ///< and what becomes of it
  ///@{
  /// For edits of regions.
  std::vector<sdk::FaceId> reference = {};
  std::vector<sdk::Match> matches = {};
  ///@}
};

/// What an edit makes of a mesh, with the normals to shade its corners with, by FaceId, and a sphere around it.
struct ShadedMesh {
  sdk::Mesh mesh;
  std::vector<std::array<Eigen::Vector3d, 3>> normals;
  sdk::Sphere around;
  Edit by;
};

/// How a mesh is being edited.
struct Editing {
  /// Of the mesh as it is, made when first asked for.
  std::map<Likeness, std::shared_ptr<const sdk::Descriptor>> descriptors = {};
  std::vector<float> similarity = {};              ///< [V], to what was compared last; or empty
  sdk::Transfer transfer{.from = 0.1, .to = 0.9};  ///< what becomes of it before it weighs
  std::shared_ptr<const ShadedMesh> tried = {};    ///< shown instead of the mesh, until it is kept or dropped; or none
  /// What an edit that was kept replaced: the mesh, and its spheres, or none.
  struct Replaced {
    std::shared_ptr<const MeshShape> mesh;
    std::shared_ptr<SphereShape> spheres;
  };
  std::vector<Replaced> before = {};  ///< the edits that were kept, to go back
};

/// Describes every vertex; `radius` is what patch shape contexts look at.
[[nodiscard]] sdk::Expected<std::shared_ptr<const sdk::Descriptor>> describe(const MeshShape& shape, Likeness by,
                                                                             double radius, const sdk::Task& task);

/// How like each vertex is to the region of some, [V], in [0, 1].
[[nodiscard]] sdk::Expected<std::vector<float>> similarity_to(const sdk::Descriptor& descriptor,
                                                              std::span<const sdk::VertexId> vertices,
                                                              const sdk::Task& task);

/// The vertices of faces, ascending, none twice.
[[nodiscard]] std::vector<sdk::VertexId> vertices_of(const sdk::Mesh& mesh, std::span<const sdk::FaceId> faces);

/// The mesh after an edit. Fails where the edit is not one of vertices or of regions, and where there is nowhere to
/// edit.
[[nodiscard]] sdk::Expected<sdk::Mesh> edited(const MeshShape& shape, const Edit& edit, const EditPlaces& places,
                                              const sdk::Task& task);

}  // namespace armature::viewer
