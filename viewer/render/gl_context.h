#pragma once

#include <memory>

#include <armature/sdk/error.h>

namespace armature::viewer {

/// OpenGL 3.3 core without a window or a display, through EGL. Used by one thread at a time.
class GlContext {
 public:
  /// Prefers Mesa's surfaceless platform; else whatever EGL finds, an X server for instance. Fails with what to install
  /// where there is no EGL or no driver.
  [[nodiscard]] static sdk::Expected<std::unique_ptr<GlContext>> create();
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  /// OpenGL calls of this thread go to this context from now on.
  [[nodiscard]] bool make_current() const;

 private:
  GlContext(void* display, void* context) : display_(display), context_(context) {}

  void* display_;  // EGLDisplay
  void* context_;  // EGLContext
};

}  // namespace armature::viewer
