#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "viewer/app/sending.h"
#include "viewer/session/job.h"
#include "viewer/session/session.h"

namespace armature::viewer {

/// A model's sphere-mesh on the card. That of many spheres is made in the background and sent in bits; until it is
/// there the drawing is that of before, or none of another model.
class SpheresDrawing : public BackgroundDrawing {
 public:
  /// A sphere-mesh of more spheres is large.
  explicit SpheresDrawing(std::size_t most_at_once) : most_at_once_(most_at_once) {}

  /// Shows what the spheres look like now, or as soon as it is there; `at_once`: now, however long that takes.
  void follow(const std::shared_ptr<const Model>& model, SpheresLook look, bool at_once);
  /// Nothing is shown any more.
  void clear();

  /// Or none.
  [[nodiscard]] const Drawing* drawing() const noexcept { return drawing_ ? &*drawing_ : nullptr; }

 private:
  /// What is drawn.
  struct Key {
    Identity model = {};
    std::uint64_t revision = 0;
    SpheresLook look = SpheresLook::Surface;
    friend bool operator==(const Key&, const Key&) = default;
  };
  void show(Drawing drawing, const Key& key);

  std::size_t most_at_once_;
  std::optional<Drawing> drawing_;
  Key key_, asked_;  // of the drawing; of the one that is being made
};

}  // namespace armature::viewer
