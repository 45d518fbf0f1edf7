#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/deformation/as_rigid_as_possible.h>
#include <armature/sdk/deformation/deform.h>
#include <armature/sdk/deformation/refit.h>
#include <armature/sdk/deformation/skinned_level.h>
#include <armature/sdk/deformation/sphere_move.h>
#include <armature/sdk/deformation/sphere_weights.h>
#include <armature/sdk/error.h>
#include <armature/sdk/hierarchy/hierarchy.h>
#include <armature/sdk/laplacian/laplacian.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// What the coordinates of a move mean.
enum class MoveFrame : std::uint8_t {
  Model,   ///< those of the model
  Parent,  ///< those of the undeformed model, carried along with the smallest sphere of the hierarchy above all that
           ///< move
};

/// How a move is carried out.
struct MoveOptions {
  MoveFrame frame = MoveFrame::Model;  ///< what its coordinates mean
  /// 0: weights blend the motions. More, for fine levels, where a sphere weighs little: what the moved spheres stand
  /// for goes with them, what the spheres within so many edges of them stand for follows as rigidly as possible, and
  /// all else stays.
  std::size_t surface_rings = 0;
};

/// A mesh that is deformed by the spheres of one level after another (thesis, section 4.7.3). Each move is carried out
/// on the mesh as it then is, so that fine edits go along with coarse moves, in whichever order they are made; after
/// each the spheres are fitted to where the mesh has gone.
///
/// A viewer calls `preview()` while something is dragged and `commit()` when it is let go, and draws `shape()` and
/// `positions()`, which change in place. Mesh and hierarchy must outlive it. Not thread-safe.
class DeformationSession {
 public:
  /// Starts at the level with so many spheres. Fails as `deform()` does. Factors once; what follows does not.
  [[nodiscard]] static Expected<DeformationSession> start(const Mesh& mesh, const Hierarchy& hierarchy,
                                                          std::size_t spheres, const DeformOptions& options = {},
                                                          const Task& task = {});

  /// The spheres of the level, in the order of `Hierarchy::nodes_of_level()`.
  [[nodiscard]] std::span<const NodeId> nodes() const noexcept { return nodes_; }
  /// The level as a sphere-mesh, as it is now, a preview included.
  [[nodiscard]] const SphereMesh& shape() const noexcept { return shape_; }
  /// [V]: where the vertices are now, a preview included.
  [[nodiscard]] std::span<const Eigen::Vector3d> positions() const noexcept { return positions_; }
  /// What moves each vertex at this level.
  [[nodiscard]] const SkinWeights& weights() const noexcept { return level_.weights(); }

  /// Changes the level; a preview is dropped. Fails for a level that the hierarchy does not have, and stays.
  [[nodiscard]] Expected<void> go_to(std::size_t spheres);

  /// Shows what a move would do, instead of any preview before. Fails for what `check()` refuses, and shows nothing.
  [[nodiscard]] Expected<void> preview(const SphereMove& move, const MoveOptions& options = {});
  /// Makes the preview a step that can be undone, and fits the spheres to the mesh.
  void commit();
  /// Drops the preview.
  void cancel();
  /// Previews and commits.
  [[nodiscard]] Expected<void> move(const SphereMove& move, const MoveOptions& options = {});

  /// What these spheres stand for stays where it is from now on, at every level; or moves again. Only what was pinned
  /// as such, a sphere of the same level, is unpinned. A step that can be undone.
  [[nodiscard]] Expected<void> pin(std::span<const SphereId> spheres, bool pinned = true);
  /// Whether a sphere of the level is pinned, or a part of one that is.
  [[nodiscard]] bool is_pinned(SphereId sphere) const noexcept { return held_[sphere.index()]; }

  /// Takes the last step back; false, and nothing, if there is none. The mesh gets its bits back; the level stays.
  bool undo();
  /// Does again what was undone last; false, and nothing, if there is none.
  bool redo();

  /// How many steps there are to undo.
  [[nodiscard]] std::size_t steps() const noexcept { return done_.size(); }

  /// All steps as text, one a line, with the level of each: see `replay()`.
  [[nodiscard]] std::string text() const;
  /// Carries out the steps of such a text, all or none: its lines are checked before anything is done, and what proves
  /// impossible later is taken back, level and steps to redo included. Fails with `name`, the line and what was
  /// expected, or as cancelled; a preview is dropped then, too. Reports every line. Numbers are in the units of the
  /// model, spheres count from 0.
  ///   armature deformation 1
  ///   vertices 24955
  ///   level 40
  ///   move spheres 3 7 translate 0 0.1 0 rotate 0 0 0.5 about 1 0 0 scale 1.1 radius 0.2 frame parent
  ///   move spheres 5 translate 0 0 0.01 surface 2
  ///   pin spheres 4
  ///   unpin spheres 4
  /// All of a move but its spheres may be left out; what follows # is a comment. On the same mesh with the same options
  /// the result is the same, bit by bit.
  [[nodiscard]] Expected<void> replay(std::string_view text, std::string_view name, const Task& task = {});

 private:
  struct Step {
    std::size_t level = 0;  // spheres
    SphereMove move = {};   // of a move; of a pin, which spheres
    MoveOptions options = {};
    std::optional<bool> pins = {};             // of a pin: whether it pins
    std::vector<VertexId> changed = {};        // by the move
    std::vector<Eigen::Vector3d> others = {};  // of each, where it is on the other side of the step
    std::vector<NodeId> nodes = {};            // whose pin changed
  };

  struct Line;  // of a text, that was checked
  [[nodiscard]] Expected<std::vector<Line>> lines_of(std::string_view text, std::string_view name) const;
  [[nodiscard]] Expected<void> carry_out(const Line& line);

  DeformationSession(const Hierarchy& hierarchy, HeatDiffusion diffusion, const Mesh& mesh, DeformOptions options);
  [[nodiscard]] Expected<void> check_level(std::size_t spheres) const;
  void show_level(std::size_t spheres);
  void weigh();
  void fit();
  void step_over(Step& step, bool forward);
  void swap_over(Step& step, bool forward);  // what `positions_` holds must be the mesh as committed
  void take_back(std::size_t steps, std::size_t level);
  [[nodiscard]] SphereMove in_model(const SphereMove& move, MoveFrame frame) const;
  [[nodiscard]] SkinWeights weights_around_pins();
  Expected<void> move_surface(const SphereMove& move, std::span<const SphereMotion> motions, std::size_t rings);

  const Mesh* mesh_;  // undeformed
  const Hierarchy* hierarchy_;
  std::unique_ptr<const HeatDiffusion> diffusion_;
  DeformOptions options_;
  Refit refit_;
  SphereWeights weights_;
  SkinnedLevel level_;  // as it was last committed
  std::vector<NodeId> nodes_;
  std::vector<bool> held_;  // by sphere of the level
  SphereMesh shape_;
  std::vector<Eigen::Vector3d> positions_;
  std::unordered_map<NodeId, FittedSphere> fits_;  // of the level, to the mesh as committed
  std::set<NodeId> pinned_;
  std::optional<Step> previewed_;
  std::optional<Laplacian> laplacian_;  // of the undeformed mesh, once a surface was moved
  struct Surface {
    std::vector<bool> free;  // by sphere of the level
    AsRigidAsPossible solver;
  };
  std::optional<Surface> surface_;  // of the last preview
  std::vector<Step> done_;
  std::vector<Step> undone_;
};

}  // namespace armature::sdk
