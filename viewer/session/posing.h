#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include <armature/sdk/deformation/session.h>

#include "viewer/session/model.h"

namespace armature::viewer {

/// A mesh that is being deformed by the spheres of its hierarchy: the sdk's session and what it needs to live.
/// Thread-safe: no; jobs change it, and what is shown meanwhile is the model's copy.
class Posing {
 public:
  /// Fails where the hierarchy is of another mesh. Takes a while: a factorisation.
  [[nodiscard]] static sdk::Expected<std::shared_ptr<Posing>> begin(std::shared_ptr<const MeshShape> mesh,
                                                                    std::shared_ptr<const sdk::Hierarchy> hierarchy,
                                                                    std::size_t spheres, const sdk::Task& task);

  ///@{
  /// As it lies now, a preview included.
  [[nodiscard]] std::span<const Eigen::Vector3d> positions() const noexcept { return session_.positions(); }
  [[nodiscard]] const sdk::SphereMesh& shape() const noexcept { return session_.shape(); }
  ///@}
  [[nodiscard]] std::size_t level() const noexcept { return shape().spheres.size(); }
  [[nodiscard]] bool is_pinned(sdk::SphereId sphere) const noexcept { return session_.is_pinned(sphere); }
  /// How many there are to undo.
  [[nodiscard]] std::size_t steps() const;
  /// All steps, as `DeformationSession::replay()` takes them.
  [[nodiscard]] std::string text() const { return session_.text(); }

  ///@{
  /// As the sdk's session has them; a replay that fails changes nothing.
  [[nodiscard]] sdk::Expected<void> move(const sdk::SphereMove& move) { return session_.move(move); }
  [[nodiscard]] sdk::Expected<void> preview(const sdk::SphereMove& move) { return session_.preview(move); }
  void cancel_preview() { session_.cancel(); }
  [[nodiscard]] sdk::Expected<void> go_to(std::size_t spheres) { return session_.go_to(spheres); }
  [[nodiscard]] sdk::Expected<void> pin(std::span<const sdk::SphereId> spheres, bool pinned) {
    return session_.pin(spheres, pinned);
  }
  [[nodiscard]] sdk::Expected<void> replay(std::string_view text, std::string_view name);
  bool undo() { return session_.undo(); }
  bool redo() { return session_.redo(); }
  ///@}

 private:
  Posing(std::shared_ptr<const MeshShape> mesh, std::shared_ptr<const sdk::Hierarchy> hierarchy,
         sdk::DeformationSession session);

  std::shared_ptr<const MeshShape> rest_;
  std::shared_ptr<const sdk::Hierarchy> hierarchy_;
  sdk::DeformationSession session_;  // refers to both
};

}  // namespace armature::viewer
