#include "viewer/render/gl_context.h"

#include <array>
#include <string>

#include <epoxy/egl.h>

namespace armature::viewer {
namespace {

tl::unexpected<sdk::Error> unavailable(const std::string& what) {
  return sdk::fail("no OpenGL 3.3 without a display here: " + what +
                   " (on Debian: apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri)");
}

EGLDisplay open_display() {
  if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless") &&
      epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_base")) {
    const EGLDisplay display = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
    if (display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr) == EGL_TRUE) return display;
  }
  const EGLDisplay display = eglGetDisplay(EGL_DEFAULT_DISPLAY);
  if (display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr) == EGL_TRUE) return display;
  return EGL_NO_DISPLAY;
}

}  // namespace

sdk::Expected<std::unique_ptr<GlContext>> GlContext::create() {
  if (!epoxy_has_egl()) return unavailable("libEGL.so.1 is missing");
  const EGLDisplay display = open_display();
  if (display == EGL_NO_DISPLAY) return unavailable("EGL finds no display to initialise");
  if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) return unavailable("EGL has no desktop OpenGL");
  constexpr std::array<EGLint, 5> kConfig = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint configs = 0;
  if (eglChooseConfig(display, kConfig.data(), &config, 1, &configs) != EGL_TRUE || configs < 1)
    return unavailable("EGL has no configuration for OpenGL");
  constexpr std::array<EGLint, 7> kContext = {
      EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  const EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, kContext.data());
  if (context == EGL_NO_CONTEXT) return unavailable("the driver offers no OpenGL 3.3 core context");
  std::unique_ptr<GlContext> result(new GlContext(display, context));
  if (!result->make_current()) return unavailable("the context works with a window only");
  return result;
}

// The display stays initialised: it is shared by all of the process.
GlContext::~GlContext() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
}

bool GlContext::make_current() const {
  return eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_TRUE;
}

}  // namespace armature::viewer
