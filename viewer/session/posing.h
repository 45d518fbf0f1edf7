#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <armature/sdk/deformation/session.h>

#include "viewer/session/session.h"

namespace armature::viewer {

/// How a mesh that is being deformed lies at some moment.
struct Pose {
  sdk::Mesh mesh = {};
  std::shared_ptr<const sdk::SphereMesh> shape = {};  ///< the spheres of the level
  sdk::Sphere around = {};                            ///< holds mesh and spheres
  std::vector<bool> pinned = {};                      ///< by sphere
  /// Of the spheres, or none: that of few is made when it is asked for, and that of a preview not at all.
  std::shared_ptr<const sdk::SphereMeshTree> tree = {};
  std::size_t steps = 0;  ///< how many there are to undo
};

///@{
/// What there is to say where no step is left.
inline constexpr const char* kNothingToUndo = "there is nothing to undo";
inline constexpr const char* kNothingToRedo = "there is nothing to redo";
///@}

/// A mesh that is being deformed by the spheres of its hierarchy: the sdk's session and what it needs to live. What
/// changes it takes long where the mesh is large, so jobs do it; each returns how the mesh then lies. Thread-safe: one
/// waits for another.
class Posing {
 public:
  using Laid = sdk::Expected<std::shared_ptr<const Pose>>;

  /// Fails where the hierarchy is of another mesh. Takes a while: a factorisation.
  [[nodiscard]] static sdk::Expected<std::shared_ptr<Posing>> begin(std::shared_ptr<const MeshShape> mesh,
                                                                    std::shared_ptr<const sdk::Hierarchy> hierarchy,
                                                                    std::size_t spheres, const sdk::Task& task);

  ///@{
  /// As the sdk's session has them; what fails changes nothing. A preview goes with whatever follows.
  [[nodiscard]] Laid lies() const;
  [[nodiscard]] Laid move(const sdk::SphereMove& move);
  [[nodiscard]] Laid preview(const sdk::SphereMove& move);
  [[nodiscard]] Laid go_to(std::size_t spheres);
  [[nodiscard]] Laid pin(std::span<const sdk::SphereId> spheres, bool pinned);
  [[nodiscard]] Laid replay(std::string_view text, std::string_view name, const sdk::Task& task);
  [[nodiscard]] Laid undo();
  [[nodiscard]] Laid redo();
  ///@}
  /// All steps, as `replay()` takes them.
  [[nodiscard]] std::string text() const;

 private:
  Posing(std::shared_ptr<const MeshShape> mesh, std::shared_ptr<const sdk::Hierarchy> hierarchy,
         sdk::DeformationSession session);
  /// Carries out what returns whether it could be.
  template <class Step>
  Laid after(const Step& step);
  [[nodiscard]] std::shared_ptr<Pose> pose(bool to_stay) const;

  std::shared_ptr<const MeshShape> rest_;
  std::shared_ptr<const sdk::Hierarchy> hierarchy_;
  mutable std::mutex mutex_;
  sdk::DeformationSession session_;  // refers to both
};

/// What else there is to a change of how a model lies.
struct Laying {
  bool lets_go = false;        ///< nothing is held afterwards
  Stops stops = Stops::Never;  ///< as the change does
};
/// Starts a job that changes how the active model lies, which must be posed.
sdk::Expected<void> lay(Session& session, std::string title,
                        std::function<Posing::Laid(Posing&, const sdk::Task&)> change, const Laying& laying = {});

}  // namespace armature::viewer
