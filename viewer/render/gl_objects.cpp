#include "viewer/render/gl_objects.h"

#include <array>
#include <vector>

namespace armature::viewer {
namespace {

std::string first_line(const char* text) {
  const std::string whole(text);
  return whole.substr(0, whole.find('\n'));
}

sdk::Expected<GLuint> compile(GLenum stage, const char* name, const char* text) {
  const GLuint shader = glCreateShader(stage);
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint compiled = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled == GL_TRUE) return shader;
  std::array<char, 1024> log{};
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  glDeleteShader(shader);
  return sdk::fail(std::string("OpenGL: shader ") + name + ": " + first_line(log.data()));
}

}  // namespace

sdk::Expected<GlProgram> make_program(const shaders::Source& source) {
  const auto vertex = compile(GL_VERTEX_SHADER, source.name, source.vertex);
  if (!vertex) return tl::unexpected(vertex.error());
  const auto fragment = compile(GL_FRAGMENT_SHADER, source.name, source.fragment);
  if (!fragment) {
    glDeleteShader(*vertex);
    return tl::unexpected(fragment.error());
  }
  GlProgram program(glCreateProgram());
  glAttachShader(program.get(), *vertex);
  glAttachShader(program.get(), *fragment);
  glLinkProgram(program.get());
  glDeleteShader(*vertex);
  glDeleteShader(*fragment);
  GLint linked = GL_FALSE;
  glGetProgramiv(program.get(), GL_LINK_STATUS, &linked);
  if (linked == GL_TRUE) return program;
  std::array<char, 1024> log{};
  glGetProgramInfoLog(program.get(), static_cast<GLsizei>(log.size()), nullptr, log.data());
  return sdk::fail(std::string("OpenGL: program ") + source.name + ": " + first_line(log.data()));
}

GlTexture make_texture(GLenum format, int width, int height) {
  GLuint name = 0;
  glGenTextures(1, &name);
  glBindTexture(GL_TEXTURE_2D, name);
  const bool depth = format == GL_DEPTH_COMPONENT32F;
  glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(format), width, height, 0, depth ? GL_DEPTH_COMPONENT : GL_RGBA,
               depth ? GL_FLOAT : GL_UNSIGNED_BYTE, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  return GlTexture(name);
}

sdk::Expected<GlFramebuffer> make_framebuffer(std::initializer_list<GLuint> colours, GLuint depth) {
  GLuint name = 0;
  glGenFramebuffers(1, &name);
  GlFramebuffer framebuffer(name);
  glBindFramebuffer(GL_FRAMEBUFFER, name);
  std::vector<GLenum> targets;
  for (const GLuint colour : colours) {
    targets.push_back(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(targets.size()));
    glFramebufferTexture2D(GL_FRAMEBUFFER, targets.back(), GL_TEXTURE_2D, colour, 0);
  }
  if (depth != 0) glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth, 0);
  glDrawBuffers(static_cast<GLsizei>(targets.size()), targets.data());
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE || glGetError() != GL_NO_ERROR)
    return sdk::fail("OpenGL: the driver cannot hold a picture of that size");
  return framebuffer;
}

}  // namespace armature::viewer
