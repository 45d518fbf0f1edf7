#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <armature/sdk/mesh/adjacency.h>
#include <armature/sdk/mesh/ids.h>

namespace armature::sdk {

/// Faces ascending, none twice: how every tool here hands them out.
[[nodiscard]] std::vector<FaceId> in_order(std::vector<FaceId> faces);

/// How many pieces these faces are, linked by edges. Faces ascend; takes time linear in the last one.
[[nodiscard]] std::size_t count_pieces(const Adjacency& adjacency, std::span<const FaceId> faces);

/// What a new set of faces does to a selection.
enum class Combine : std::uint8_t {
  Replace,    ///< it is the selection
  Add,        ///< selects it too
  Subtract,   ///< selects it no longer
  Intersect,  ///< keeps what lies in it
};

/// The faces of one mesh that a user has selected, and the way there. A step is remembered by the faces that it
/// changed, so undoing takes time linear in the selection. Thread-safe: no.
class Selection {
 public:
  /// Nothing selected.
  Selection() = default;
  /// Some faces, in any order; there is nothing to undo.
  explicit Selection(std::vector<FaceId> faces) : faces_(in_order(std::move(faces))) {}

  /// Ascending, none twice.
  [[nodiscard]] const std::vector<FaceId>& faces() const noexcept { return faces_; }
  /// Whether a face is selected; time logarithmic in the selection.
  [[nodiscard]] bool contains(FaceId face) const noexcept;

  /// Takes faces in any order. One step to undo, even where nothing changes; what was undone cannot be redone any more.
  void combine(std::vector<FaceId> faces, Combine how);
  /// Takes back the last step; false where there is none.
  bool undo();
  /// Takes the last step that was undone again; false where there is none.
  bool redo();

 private:
  void toggle(std::span<const FaceId> changed);

  std::vector<FaceId> faces_;
  std::vector<std::vector<FaceId>> changes_;  // by step
  std::size_t taken_ = 0;                     // how many of these hold
};

}  // namespace armature::sdk
