#include "viewer/render/renderer.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <string>

#include <Eigen/Geometry>

#include "viewer/render/gl_context.h"
#include "viewer/render/gl_objects.h"

namespace armature::viewer {
namespace {

using Eigen::Matrix4d;
using Eigen::Matrix4f;

constexpr int kMostSamplesASide = 3;
/// Samples of one picture: beyond, fewer fall on a pixel. 28 bytes each.
constexpr double kMostSamples = 32e6;
/// How far obscurance reaches, in radii of the scene.
constexpr double kObscuranceReach = 0.35;
constexpr float kLineWidthPx = 0.8F;

/// As many samples a side of a pixel as a picture of that size affords.
int samples_a_side(int width, int height) {
  const double affordable = std::sqrt(kMostSamples / (static_cast<double>(width) * height));
  return std::clamp(static_cast<int>(affordable), 1, kMostSamplesASide);
}

/// Light as pictures are mixed in, of a colour on the screen.
std::array<float, 3> unit(const sdk::Colour& colour) {
  return {static_cast<float>(colour[0]) / 255, static_cast<float>(colour[1]) / 255,
          static_cast<float>(colour[2]) / 255};
}

/// The view with its unit such that the far plane lies at 1: well inside single precision for any model.
struct Projection {
  Matrix4f view_from_local;
  Matrix4f clip_from_view;
  float view_scale;                    // view units a local unit
  std::array<float, 2> depth_of_clip;  // z = -second / (ndc + first)
};

Projection projection(const Camera& camera, const sdk::Sphere& frame) {
  const double unit = 1 / camera.far;
  Matrix4d local = Matrix4d::Identity();
  local.topLeftCorner<3, 3>() *= frame.radius;
  local.topRightCorner<3, 1>() = frame.centre;
  Matrix4d view_from_local = camera.view_from_world.matrix() * local;
  view_from_local.topRows<3>() *= unit;
  const double near = camera.near * unit;
  const double a = -(1 + near) / (1 - near);
  const double b = -2 * near / (1 - near);
  Matrix4d clip_from_view = Matrix4d::Zero();
  clip_from_view(0, 0) = 1 / camera.half_width;
  clip_from_view(1, 1) = 1 / camera.half_height;
  clip_from_view(2, 2) = a;
  clip_from_view(2, 3) = b;
  clip_from_view(3, 2) = -1;
  return {.view_from_local = view_from_local.cast<float>(),
          .clip_from_view = clip_from_view.cast<float>(),
          .view_scale = static_cast<float>(frame.radius * unit),
          .depth_of_clip = {static_cast<float>(a), static_cast<float>(b)}};
}

/// One member of a record of vertices or instances, as the vertex stage takes it in.
struct Input {
  GLint components;
  GLenum type;
  std::size_t offset;
  bool integer = false;
};

/// Draws records that are gone from the card afterwards: a picture is drawn once.
template <class Record>
class Records {
 public:
  Records(const std::vector<Record>& records, std::initializer_list<Input> inputs, bool instanced) {
    GLuint name = 0;
    glGenVertexArrays(1, &name);
    array_ = GlVertexArray(name);
    glBindVertexArray(name);
    glGenBuffers(1, &name);
    buffer_ = GlBuffer(name);
    glBindBuffer(GL_ARRAY_BUFFER, name);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(records.size() * sizeof(Record)), records.data(),
                 GL_STREAM_DRAW);
    GLuint index = 0;
    for (const Input& input : inputs) {
      // NOLINTNEXTLINE(performance-no-int-to-ptr): an offset into the buffer, as OpenGL has it.
      const auto* offset = reinterpret_cast<const void*>(input.offset);
      if (input.integer) {
        glVertexAttribIPointer(index, input.components, input.type, sizeof(Record), offset);
      } else {
        const bool bytes = input.type == GL_UNSIGNED_BYTE;
        glVertexAttribPointer(index, input.components, input.type, bytes ? GL_TRUE : GL_FALSE, sizeof(Record), offset);
      }
      if (instanced) glVertexAttribDivisor(index, 1);
      glEnableVertexAttribArray(index++);
    }
  }

 private:
  GlVertexArray array_;
  GlBuffer buffer_;
};

}  // namespace

class Renderer::Implementation {
 public:
  [[nodiscard]] static sdk::Expected<std::unique_ptr<Implementation>> create() {
    auto context = GlContext::create();
    if (!context) return tl::unexpected(context.error());
    std::unique_ptr<Implementation> result(new Implementation(std::move(*context)));
    for (const auto& [program, source] :
         {std::pair{&result->triangles_, &shaders::kTriangles}, std::pair{&result->balls_, &shaders::kBalls},
          std::pair{&result->cones_, &shaders::kCones}, std::pair{&result->light_, &shaders::kLight},
          std::pair{&result->resolve_, &shaders::kResolve}}) {
      auto made = make_program(*source);
      if (!made) return tl::unexpected(made.error());
      *program = std::move(*made);
    }
    GLuint name = 0;
    glGenVertexArrays(1, &name);
    result->no_input_ = GlVertexArray(name);
    return result;
  }
  ~Implementation() { static_cast<void>(context_->make_current()); }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  [[nodiscard]] sdk::Expected<Image> draw(const Scene& scene, const Camera& camera, int width, int height) {
    if (!context_->make_current()) return sdk::fail("OpenGL: the context is in use by another thread");
    if (auto sized = resize(width, height); !sized) return tl::unexpected(sized.error());
    const Projection view = projection(camera, scene.frame());

    glViewport(0, 0, width * samples_, height * samples_);
    draw_layer(scene, Layer::Solid, view);
    light_layer(scene, Layer::Solid, camera, view);
    const Scene::Content& glass = scene.content(Layer::Glass);
    if (!(glass.corners.empty() && glass.balls.empty() && glass.cones.empty())) {
      draw_layer(scene, Layer::Glass, view);
      light_layer(scene, Layer::Glass, camera, view);
    }
    return resolve(width, height);
  }

 private:
  explicit Implementation(std::unique_ptr<GlContext> context) : context_(std::move(context)) {}

  sdk::Expected<void> resize(int width, int height) {
    if (width == width_ && height == height_) return {};
    samples_ = samples_a_side(width, height);
    const int wide = width * samples_;
    const int high = height * samples_;
    GLint most = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
    if (wide > most || high > most) {
      return sdk::fail("OpenGL: expected a picture of at most " + std::to_string(most) + " pixels a side");
    }
    while (glGetError() != GL_NO_ERROR) {
    }
    width_ = height_ = 0;
    albedo_ = make_texture(GL_RGBA8, wide, high);
    normal_ = make_texture(GL_RGBA16F, wide, high);
    for (GlTexture& depth : depth_) depth = make_texture(GL_DEPTH_COMPONENT32F, wide, high);
    lit_ = make_texture(GL_RGBA16F, wide, high);
    picture_ = make_texture(GL_RGBA8, width, height);
    for (std::size_t layer = 0; layer < 2; ++layer) {
      auto framebuffer = make_framebuffer({albedo_.get(), normal_.get()}, depth_[layer].get());
      if (!framebuffer) return tl::unexpected(framebuffer.error());
      surfaces_[layer] = std::move(*framebuffer);
    }
    auto lit = make_framebuffer({lit_.get()}, 0);
    if (!lit) return tl::unexpected(lit.error());
    auto picture = make_framebuffer({picture_.get()}, 0);
    if (!picture) return tl::unexpected(picture.error());
    lights_ = std::move(*lit);
    pixels_ = std::move(*picture);
    width_ = width;
    height_ = height;
    return {};
  }

  void draw_layer(const Scene& scene, Layer layer, const Projection& view) {
    glBindFramebuffer(GL_FRAMEBUFFER, surfaces_[static_cast<std::size_t>(layer)].get());
    glEnable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glClearColor(0, 0, 0, 0);
    glClearDepth(1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    const Scene::Content& content = scene.content(layer);
    if (!content.corners.empty()) {
      use(triangles_, view);
      set("line_colour", unit(scene.palette().line));
      set("inside_colour", unit(scene.palette().inside));
      set("line_width", kLineWidthPx * static_cast<float>(samples_));
      const Records records(content.corners,
                            {{3, GL_FLOAT, offsetof(Scene::Corner, position)},
                             {3, GL_FLOAT, offsetof(Scene::Corner, normal)},
                             {3, GL_UNSIGNED_BYTE, offsetof(Scene::Corner, colour)},
                             {1, GL_UNSIGNED_BYTE, offsetof(Scene::Corner, flags), true}},
                            false);
      glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(content.corners.size()));
    }
    if (!content.balls.empty()) {
      use(balls_, view);
      const Records records(
          content.balls,
          {{4, GL_FLOAT, offsetof(Scene::Ball, sphere)}, {3, GL_UNSIGNED_BYTE, offsetof(Scene::Ball, colour)}}, true);
      glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(content.balls.size()));
    }
    if (!content.cones.empty()) {
      use(cones_, view);
      const Records records(content.cones,
                            {{4, GL_FLOAT, offsetof(Scene::Cone, a)},
                             {4, GL_FLOAT, offsetof(Scene::Cone, b)},
                             {3, GL_UNSIGNED_BYTE, offsetof(Scene::Cone, colour)}},
                            true);
      // A box's far side alone: each of its pixels once.
      glEnable(GL_CULL_FACE);
      glCullFace(GL_FRONT);
      glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 14, static_cast<GLsizei>(content.cones.size()));
      glDisable(GL_CULL_FACE);
    }
  }

  void light_layer(const Scene& scene, Layer layer, const Camera& camera, const Projection& view) {
    glBindFramebuffer(GL_FRAMEBUFFER, lights_.get());
    glDisable(GL_DEPTH_TEST);
    if (layer == Layer::Glass) {
      glEnable(GL_BLEND);
      glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    }
    use(light_, view);
    set_texture("albedo_map", 0, albedo_);
    set_texture("normal_map", 1, normal_);
    set_texture("depth_map", 2, depth_[static_cast<std::size_t>(layer)]);
    set_texture("solid_depth_map", 3, depth_[static_cast<std::size_t>(Layer::Solid)]);
    glUniform1i(place("glass"), layer == Layer::Glass ? 1 : 0);
    glUniform2f(place("tangents"), static_cast<float>(camera.half_width), static_cast<float>(camera.half_height));
    glUniform2f(place("depth_of_clip"), view.depth_of_clip[0], view.depth_of_clip[1]);
    set("reach", static_cast<float>(kObscuranceReach) * view.view_scale);
    set("background_top", unit(scene.palette().background_top));
    set("background_bottom", unit(scene.palette().background_bottom));
    draw_whole_picture();
  }

  sdk::Expected<Image> resolve(int width, int height) {
    glBindFramebuffer(GL_FRAMEBUFFER, pixels_.get());
    glDisable(GL_BLEND);
    glViewport(0, 0, width, height);
    program_ = resolve_.get();
    glUseProgram(program_);
    set_texture("light_map", 0, lit_);
    glUniform1i(place("samples"), samples_);
    draw_whole_picture();

    Image image{.width = width, .height = height, .rgb = {}};
    const std::size_t row = 3 * static_cast<std::size_t>(width);
    image.rgb.resize(row * static_cast<std::size_t>(height));
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, image.rgb.data());
    if (const GLenum error = glGetError(); error != GL_NO_ERROR)
      return sdk::fail("OpenGL: error " + std::to_string(error) + " while drawing");
    // OpenGL's first row is the lowest.
    for (auto top = image.rgb.begin(), bottom = image.rgb.end(); top < bottom;
         top += static_cast<std::ptrdiff_t>(row)) {
      bottom -= static_cast<std::ptrdiff_t>(row);
      if (top < bottom) std::swap_ranges(top, top + static_cast<std::ptrdiff_t>(row), bottom);
    }
    return image;
  }

  void draw_whole_picture() {
    glBindVertexArray(no_input_.get());
    glDrawArrays(GL_TRIANGLES, 0, 3);
  }

  void use(const GlProgram& program, const Projection& view) {
    program_ = program.get();
    glUseProgram(program_);
    glUniformMatrix4fv(place("view_from_local"), 1, GL_FALSE, view.view_from_local.data());
    glUniformMatrix4fv(place("clip_from_view"), 1, GL_FALSE, view.clip_from_view.data());
    set("view_scale", view.view_scale);
  }
  [[nodiscard]] GLint place(const char* name) const { return glGetUniformLocation(program_, name); }
  void set(const char* name, float value) const { glUniform1f(place(name), value); }
  void set(const char* name, const std::array<float, 3>& value) const { glUniform3fv(place(name), 1, value.data()); }
  void set_texture(const char* name, GLint unit, const GlTexture& texture) const {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
    glBindTexture(GL_TEXTURE_2D, texture.get());
    glUniform1i(place(name), unit);
  }

  std::unique_ptr<GlContext> context_;  // first: the rest dies before it
  GlProgram triangles_, balls_, cones_, light_, resolve_;
  GLuint program_ = 0;  // the one in use
  GlVertexArray no_input_;
  int width_ = 0, height_ = 0, samples_ = 1;
  GlTexture albedo_, normal_, lit_, picture_;
  std::array<GlTexture, 2> depth_;         // by Layer
  std::array<GlFramebuffer, 2> surfaces_;  // by Layer: albedo, normal, depth
  GlFramebuffer lights_, pixels_;
};

Renderer::Renderer(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

sdk::Expected<Renderer> Renderer::create() {
  auto implementation = Implementation::create();
  if (!implementation) return tl::unexpected(implementation.error());
  return Renderer(std::move(*implementation));
}

sdk::Expected<Image> Renderer::draw(const Scene& scene, const Camera& camera, int width, int height) {
  assert(width > 0 && height > 0);
  return implementation_->draw(scene, camera, width, height);
}

}  // namespace armature::viewer
