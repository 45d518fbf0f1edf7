#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "viewer/render/drawing.h"
#include "viewer/session/job.h"

namespace armature::viewer {

/// A scene on its way to the card, a few milliseconds a frame. Made, used and deleted while its context is current.
class Sending {
 public:
  explicit Sending(std::shared_ptr<const Scene> scene)
      : scene_(std::move(scene)), drawing_(*scene_, Drawing::InBits()) {}

  /// Whether all of it is there.
  bool go_on();
  /// Once it is.
  [[nodiscard]] Drawing take() { return std::move(drawing_); }
  [[nodiscard]] const std::shared_ptr<const Scene>& scene() const noexcept { return scene_; }

 private:
  std::shared_ptr<const Scene> scene_;
  Drawing drawing_;
};

/// What a drawing is of: no other is ever the same, and it does not keep it from going.
class Identity {
 public:
  Identity() = default;
  explicit Identity(const std::shared_ptr<const void>& of) : of_(of) {}
  friend bool operator==(const Identity& a, const Identity& b) noexcept {
    return !a.of_.owner_before(b.of_) && !b.of_.owner_before(a.of_);
  }

 private:
  std::weak_ptr<const void> of_;
};

/// What drawings have in common whose scenes are made in the background, one at a time, and then sent to the card in
/// bits. Made, used and deleted while its context is current.
class BackgroundDrawing {
 public:
  /// Nothing of it is shown: what is being made is not wanted.
  void rest();
  /// How often what is to be drawn has changed.
  [[nodiscard]] std::uint64_t changes() const noexcept { return changes_; }
  /// What kept it from being made, once: it is not tried again until something else is to be drawn.
  [[nodiscard]] std::optional<std::string> take_complaint() { return std::exchange(complaint_, std::nullopt); }
  /// Whether something is being made.
  [[nodiscard]] bool making() const noexcept { return making_.running() || !sending_.empty(); }

 protected:
  BackgroundDrawing() = default;
  ~BackgroundDrawing() = default;
  /// Takes what the background has made, or why it could not be.
  void take_made();
  /// Sends on; once all scenes have arrived, the drawings of them.
  [[nodiscard]] std::optional<std::vector<Drawing>> take_sent();

  std::vector<Sending> sending_;
  std::uint64_t changes_ = 0;
  bool failed_ = false;  // to make what was asked for
  std::optional<std::string> complaint_;
  Job making_;  // goes first
};

}  // namespace armature::viewer
