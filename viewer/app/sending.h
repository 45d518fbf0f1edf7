#pragma once

#include <memory>

#include "viewer/render/drawing.h"

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

 private:
  std::shared_ptr<const Scene> scene_;
  Drawing drawing_;
};

}  // namespace armature::viewer
