#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <armature/sdk/distance/measure.h>
#include <armature/sdk/distance/sphere_mesh_tree.h>
#include <armature/sdk/expansion/component_index.h>
#include <armature/sdk/expansion/expansion.h>
#include <armature/sdk/hierarchy/hierarchy.h>
#include <armature/sdk/hierarchy/level_cursor.h>
#include <armature/sdk/selection/boundary.h>
#include <armature/sdk/selection/part_cut.h>
#include <armature/sdk/selection/patch_brush.h>
#include <armature/sdk/selection/selection.h>
#include <armature/sdk/selection/surface.h>
#include <armature/sdk/spheremesh/sphere_mesh.h>

#include "viewer/session/editing.h"
#include "viewer/session/made_once.h"

namespace armature::viewer {

/// A mesh with what picking and tools look at. Immutable; jobs may share it.
class MeshShape {
 public:
  explicit MeshShape(sdk::Mesh of);
  ///@{
  /// What cutting and clicking look at; takes long when it is first asked for. Thread-safe. It must not outlive this.
  [[nodiscard]] sdk::Expected<std::shared_ptr<const sdk::PartModel>> parts(const sdk::Task& task) const;
  [[nodiscard]] sdk::Expected<std::shared_ptr<const sdk::ComponentIndex>> components(const sdk::Task& task) const;
  ///@}

  const sdk::Mesh mesh;
  const sdk::Surface surface;
  const sdk::Sphere around;                                   ///< holds it
  const std::vector<std::array<Eigen::Vector3d, 3>> normals;  ///< to shade its corners with, by FaceId

 private:
  mutable MadeOnce<sdk::PartModel> parts_;
  mutable MadeOnce<sdk::ComponentIndex> components_;
};

/// How far a sphere-mesh leaves its mesh.
struct LevelErrors : sdk::ApproximationErrors {
  bool about = false;  ///< measured quickly: the means are close, the largest may be somewhat larger
};

/// A sphere-mesh, or the level that is shown of a hierarchy.
struct SphereShape {
  std::shared_ptr<const sdk::Hierarchy> hierarchy;  ///< or none
  std::optional<sdk::LevelCursor> cursor;           ///< where there is a hierarchy
  std::shared_ptr<const sdk::SphereMesh> shape;     ///< never none; jobs may share it
  sdk::Sphere around;                               ///< holds it
  std::shared_ptr<const sdk::SphereMeshTree> tree;  ///< of `shape`, made when it is first asked for
  std::optional<LevelErrors> errors;                ///< of `shape` against the mesh, once they are measured
  std::string unmeasured;                           ///< why that cannot be done
  /// Shows another shape.
  void show(std::shared_ptr<const sdk::SphereMesh> other);
  /// What was found out about the shape before counts no longer.
  void changed();
};

/// A level that is made apart from what is shown, and the way there.
struct Level {
  sdk::LevelCursor cursor;
  std::shared_ptr<const sdk::SphereMesh> shape;
  sdk::Sphere around;
  std::shared_ptr<const sdk::SphereMeshTree> tree;
};
/// A level of a hierarchy. Takes as long as copying the cursor, which nobody may move meanwhile, and longer.
[[nodiscard]] Level make_level(const sdk::LevelCursor& from, std::size_t spheres);

/// What regions of a mesh are selected, and the regions like the last one.
struct Selecting {
  enum class Kind : std::uint8_t { None, Component, Part, Patch, Lasso };
  sdk::Selection selection;
  std::size_t pieces = 0;                       ///< that it is in
  Kind kind = Kind::None;                       ///< of the last gesture
  std::vector<sdk::FaceId> reference;           ///< its faces, ascending
  std::optional<sdk::Expansion> expansion;      ///< what is like it, once it was looked for
  std::size_t shown = 0;                        ///< the best matches that are shown,
  std::vector<int> more_shown;                  ///< and how many more since each verdict, by the verdict itself
  std::vector<sdk::FaceId> drawn;               ///< what the gesture that goes on would select; no command knows it
  std::shared_ptr<const sdk::PartModel> parts;  ///< of the cut
  std::shared_ptr<const sdk::PartCut> cut;      ///< whose strokes go on
  sdk::PatchStrokes strokes;                    ///< of the patch that is brushed
};

/// A drag of a boundary as tools make it: half as far again as the way that it goes moves along, and a little more.
[[nodiscard]] sdk::BoundaryDrag boundary_drag(const sdk::Surface& surface, const sdk::SurfacePoint& from,
                                              const sdk::SurfacePoint& to, double snap);

class Posing;
struct Pose;

/// What a hierarchy shows first: few enough spheres to see what it does.
inline constexpr std::size_t kFirstLevel = 60;

/// Something that is open: a mesh, a sphere-mesh, or both of the same shape.
struct Model {
  std::string name;
  std::filesystem::path path;  ///< empty for what was made here
  std::shared_ptr<const MeshShape> mesh;
  std::optional<SphereShape> spheres;
  Selecting selecting;
  std::shared_ptr<Posing> posing;         ///< while the mesh is being deformed
  std::shared_ptr<const Pose> pose;       ///< how it lies then,
  std::shared_ptr<const Pose> previewed;  ///< or would lie; or none
  Editing editing;
  std::vector<sdk::SphereId> handle;  ///< what is held of its level
  std::vector<float> values;          ///< of a map, by vertex, in [0, 1]; or empty
  /// Changes with what is drawn of each: the mesh's shape, its colours, the spheres.
  std::uint64_t mesh_revision = 1, colour_revision = 1, spheres_revision = 1;

  /// Goes to a level of the hierarchy, which must have it; or to one that was made before, which then holds what was
  /// there.
  void go_to(std::size_t spheres);
  void go_to(Level& level);
  /// Replaces the sphere-mesh; the hierarchy goes.
  void set_spheres(sdk::SphereMesh shape);
  /// Replaces the level that is shown; the hierarchy stays, and its next level comes from there.
  void set_refined(std::shared_ptr<const sdk::SphereMesh> shape);
  void set_hierarchy(std::shared_ptr<const sdk::Hierarchy> hierarchy, std::size_t spheres);
  /// Has no spheres any more; what they were, which may take a while to go, or none.
  std::shared_ptr<SphereShape> take_spheres();
  /// Has these instead of any; or none.
  void put_spheres(std::shared_ptr<SphereShape> taken);
  ///@{
  /// Shows spheres and mesh as they lie from now on; as they would lie, or no longer.
  void lay(std::shared_ptr<const Pose> as);
  void preview(std::shared_ptr<const Pose> as);
  ///@}
  /// The mesh as it is shown: posed, with the edit that is tried, or as it is. There must be one.
  [[nodiscard]] const sdk::Mesh& shown_mesh() const;
  /// A sphere that holds all of it at rest, and tells its size.
  [[nodiscard]] sdk::Sphere around() const;
  /// One that holds all that is shown of it: posed, edited, and its spheres.
  [[nodiscard]] sdk::Sphere extent() const;
  /// The same without what is previewed, which no command knows.
  [[nodiscard]] sdk::Sphere lasting_extent() const;
  /// For picking; there must be spheres.
  [[nodiscard]] const sdk::SphereMeshTree& sphere_tree();
};

/// The file's extension in small letters, with its dot.
[[nodiscard]] std::string lower_extension(const std::filesystem::path& path);

/// Reads a mesh, a sphere-mesh or a hierarchy (.smh), whatever the file holds.
[[nodiscard]] sdk::Expected<std::shared_ptr<Model>> read_model(const std::filesystem::path& path,
                                                               const sdk::Task& task);

/// The model's sphere-mesh (.ma, .urdf, .ply), hierarchy (.smh) or mesh (.obj, .off, .ply), by the extension. A .ply
/// file gets the spheres where `spheres` says so. Mesh and spheres are written as they are shown, posed; a hierarchy is
/// that of the mesh at rest. Fails while an edit is tried.
[[nodiscard]] sdk::Expected<void> write_model(const Model& model, const std::filesystem::path& path, bool spheres);

}  // namespace armature::viewer
