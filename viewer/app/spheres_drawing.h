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
/// there the drawing is that of before, or none of another model. Made, used and deleted while its context is current.
class SpheresDrawing {
 public:
  /// A sphere-mesh of more spheres is large.
  explicit SpheresDrawing(std::size_t most_at_once) : most_at_once_(most_at_once) {}

  /// Shows what the spheres look like now, or as soon as it is there; `at_once`: now, however long that takes.
  void follow(const std::shared_ptr<const Model>& model, SpheresLook look, bool at_once);
  /// Nothing of it is shown: what is being made is not wanted.
  void rest();

  /// Or none.
  [[nodiscard]] const Drawing* drawing() const noexcept { return drawing_ ? &*drawing_ : nullptr; }
  /// How often it has changed.
  [[nodiscard]] std::uint64_t changes() const noexcept { return changes_; }
  /// What kept it from being made, once: it is not tried again until something else is to be drawn.
  [[nodiscard]] std::optional<std::string> take_complaint() { return std::exchange(complaint_, std::nullopt); }
  /// Whether another one is being made.
  [[nodiscard]] bool making() const noexcept { return making_.running() || sending_.has_value(); }

 private:
  /// What is drawn.
  struct Key {
    std::shared_ptr<const void> model = nullptr;  // held, so that no other takes its place
    std::uint64_t revision = 0;
    SpheresLook look = SpheresLook::Surface;
    friend bool operator==(const Key&, const Key&) = default;
  };
  void show(Drawing drawing, const Key& key);

  std::size_t most_at_once_;
  std::optional<Drawing> drawing_;
  Key key_, asked_;  // of the drawing; of the one that is being made
  std::uint64_t changes_ = 0;
  Job making_;
  bool failed_ = false;  // to make what was asked for
  std::optional<std::string> complaint_;
  std::optional<Sending> sending_;
};

}  // namespace armature::viewer
