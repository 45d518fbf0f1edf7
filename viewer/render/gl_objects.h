#pragma once

#include <span>
#include <string>
#include <utility>

#include <armature/sdk/error.h>
#include <epoxy/gl.h>

#include "viewer/render/shaders.h"

namespace armature::viewer {

/// The name of an OpenGL object, deleted with it. The context in which it was made must be current then.
template <void (*Delete)(GLuint)>
class GlName {
 public:
  GlName() = default;
  explicit GlName(GLuint name) : name_(name) {}
  GlName(GlName&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  GlName& operator=(GlName&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  ~GlName() {
    if (name_ != 0) Delete(name_);
  }

  [[nodiscard]] GLuint get() const noexcept { return name_; }

 private:
  GLuint name_ = 0;
};

inline void delete_buffer(GLuint name) {
  glDeleteBuffers(1, &name);
}
inline void delete_framebuffer(GLuint name) {
  glDeleteFramebuffers(1, &name);
}
inline void delete_program(GLuint name) {
  glDeleteProgram(name);
}
inline void delete_texture(GLuint name) {
  glDeleteTextures(1, &name);
}
inline void delete_vertex_array(GLuint name) {
  glDeleteVertexArrays(1, &name);
}

using GlBuffer = GlName<delete_buffer>;
using GlFramebuffer = GlName<delete_framebuffer>;
using GlProgram = GlName<delete_program>;
using GlTexture = GlName<delete_texture>;
using GlVertexArray = GlName<delete_vertex_array>;

/// Compiles and links; fails with the first line of the driver's complaint.
[[nodiscard]] sdk::Expected<GlProgram> make_program(const shaders::Source& source);

/// A texture of one level, read texel by texel.
[[nodiscard]] GlTexture make_texture(GLenum format, int width, int height);

/// What is drawn into: `colours` in order, and a depth where it is not 0. Fails where the driver cannot.
[[nodiscard]] sdk::Expected<GlFramebuffer> make_framebuffer(std::initializer_list<GLuint> colours, GLuint depth);

}  // namespace armature::viewer
