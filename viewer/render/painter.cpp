#include "viewer/render/painter.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <Eigen/Geometry>

#include "viewer/render/shaders.h"

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
///@{
/// What is done at once.
constexpr GLsizei kCornersAStep = 3 * 65'536;
constexpr GLsizei kInstancesAStep = 1 << 14;
constexpr GLsizei kSamplesAStep = 1 << 18;
///@}

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

}  // namespace

/// The view with its unit such that the far plane lies at 1: well inside single precision for any model.
struct Painter::View {
  Matrix4f view_from_local;
  Matrix4f clip_from_view;
  float scale;                         // view units a local unit
  std::array<float, 2> depth_of_clip;  // z = -second / (ndc + first)

  View(const Camera& camera, const sdk::Sphere& frame) {
    const double unit = 1 / camera.far;
    Matrix4d local = Matrix4d::Identity();
    local.topLeftCorner<3, 3>() *= frame.radius;
    local.topRightCorner<3, 1>() = frame.centre;
    Matrix4d view = camera.view_from_world.matrix() * local;
    view.topRows<3>() *= unit;
    const double near = camera.near * unit;
    const double a = -(1 + near) / (1 - near);
    const double b = -2 * near / (1 - near);
    Matrix4d clip = Matrix4d::Zero();
    clip(0, 0) = 1 / camera.half_width;
    clip(1, 1) = 1 / camera.half_height;
    clip(2, 2) = a;
    clip(2, 3) = b;
    clip(3, 2) = -1;
    view_from_local = view.cast<float>();
    clip_from_view = clip.cast<float>();
    scale = static_cast<float>(frame.radius * unit);
    depth_of_clip = {static_cast<float>(a), static_cast<float>(b)};
  }
};

sdk::Expected<Painter> Painter::create() {
  Painter result;
  for (const auto& [program, source] :
       {std::pair{&result.triangles_, &shaders::kTriangles}, std::pair{&result.balls_, &shaders::kBalls},
        std::pair{&result.cones_, &shaders::kCones}, std::pair{&result.light_, &shaders::kLight},
        std::pair{&result.resolve_, &shaders::kResolve}}) {
    auto made = make_program(*source);
    if (!made) return tl::unexpected(made.error());
    *program = std::move(*made);
  }
  GLuint name = 0;
  glGenVertexArrays(1, &name);
  result.no_input_ = GlVertexArray(name);
  return result;
}

sdk::Expected<void> Painter::paint(std::span<const Drawing* const> drawings, const Camera& camera, int width,
                                   int height, const PaintOptions& options) {
  if (auto begun = begin(drawings, camera, width, height, options); !begun) return begun;
  while (!go_on()) {
  }
  return {};
}

sdk::Expected<void> Painter::begin(std::span<const Drawing* const> drawings, const Camera& camera, int width,
                                   int height, const PaintOptions& options) {
  steps_.clear();
  done_ = 0;
  const int samples = options.samples_a_side > 0 ? options.samples_a_side : samples_a_side(width, height);
  if (auto sized = resize(width, height, samples); !sized) return sized;
  camera_ = camera;
  obscurance_ = options.obscurance;
  plan_layer(drawings, Layer::Solid, options.most_ray_cast);
  const auto has_glass = [](const Drawing* drawing) { return !drawing->content(Layer::Glass).empty(); };
  if (std::any_of(drawings.begin(), drawings.end(), has_glass))
    plan_layer(drawings, Layer::Glass, options.most_ray_cast);
  steps_.push_back({.kind = Step::Kind::Resolve});
  return {};
}

bool Painter::go_on() {
  if (done_ < steps_.size()) take(steps_[done_++]);
  return done_ == steps_.size();
}

/// What is drawn of a layer, then the light on it.
void Painter::plan_layer(std::span<const Drawing* const> drawings, Layer layer, GLsizei most_ray_cast) {
  using Kind = Step::Kind;
  steps_.push_back({.kind = Kind::Clear, .layer = layer});
  for (const Drawing* drawing : drawings) {
    const Drawing::Content& content = drawing->content(layer);
    const auto plan = [&](Kind kind, GLsizei count, GLsizei at_once) {
      for (GLint first = 0; first < count; first += at_once)
        steps_.push_back({kind, layer, drawing, first, std::min(at_once, count - first)});
    };
    plan(Kind::Corners, content.corners.count(), kCornersAStep);
    if (content.corners.count() > 0 && content.balls.count() + content.cones.count() > most_ray_cast) continue;
    plan(Kind::Balls, content.balls.count(), kInstancesAStep);
    plan(Kind::Cones, content.cones.count(), kInstancesAStep);
  }
  const GLsizei rows = height_ * samples_;
  const GLsizei rows_a_step = std::max(1, kSamplesAStep / (width_ * samples_));
  for (GLint first = 0; first < rows; first += rows_a_step)
    steps_.push_back({Kind::Light, layer, drawings.front(), first, std::min(rows_a_step, rows - first)});
}

void Painter::take(const Step& step) {
  // Whoever drew in between has left things as he liked.
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_CULL_FACE);
  glDisable(GL_BLEND);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  glViewport(0, 0, width_ * samples_, height_ * samples_);
  switch (step.kind) {
    case Step::Kind::Clear: return clear(step.layer);
    case Step::Kind::Corners:
    case Step::Kind::Balls:
    case Step::Kind::Cones: return draw(step);
    case Step::Kind::Light: return light(step);
    case Step::Kind::Resolve: return resolve();
  }
}

sdk::Expected<void> Painter::resize(int width, int height, int samples) {
  if (width == width_ && height == height_ && samples == samples_) return {};
  samples_ = samples;
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

void Painter::clear(Layer layer) {
  glBindFramebuffer(GL_FRAMEBUFFER, surfaces_[static_cast<std::size_t>(layer)].get());
  glDepthMask(GL_TRUE);
  glClearColor(0, 0, 0, 0);
  glClearDepth(1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

void Painter::draw(const Step& step) {
  glBindFramebuffer(GL_FRAMEBUFFER, surfaces_[static_cast<std::size_t>(step.layer)].get());
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LESS);
  const Drawing& drawing = *step.drawing;
  const View view(camera_, drawing.frame());
  const Drawing::Content& content = drawing.content(step.layer);
  if (step.kind == Step::Kind::Corners) {
    use(triangles_, view);
    set("line_colour", unit(drawing.palette().line));
    set("inside_colour", unit(drawing.palette().inside));
    set("line_width", kLineWidthPx * static_cast<float>(samples_));
    content.corners.bind();
    glDrawArrays(GL_TRIANGLES, step.first, step.count);
  } else if (step.kind == Step::Kind::Balls) {
    use(balls_, view);
    content.balls.bind_from(step.first);
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, step.count);
  } else {
    use(cones_, view);
    content.cones.bind_from(step.first);
    // A box's far side alone: each of its pixels once.
    glEnable(GL_CULL_FACE);
    glFrontFace(GL_CCW);
    glCullFace(GL_FRONT);
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 14, step.count);
    glDisable(GL_CULL_FACE);
  }
}

/// A strip of the picture.
void Painter::light(const Step& step) {
  const Palette& palette = step.drawing->palette();
  const View view(camera_, step.drawing->frame());
  const bool glass = step.layer == Layer::Glass;
  glBindFramebuffer(GL_FRAMEBUFFER, lights_.get());
  glDisable(GL_DEPTH_TEST);
  if (glass) {
    glEnable(GL_BLEND);
    glBlendEquation(GL_FUNC_ADD);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  }
  glEnable(GL_SCISSOR_TEST);
  glScissor(0, step.first, width_ * samples_, step.count);
  use(light_);
  set_texture("albedo_map", 0, albedo_);
  set_texture("normal_map", 1, normal_);
  set_texture("depth_map", 2, depth_[static_cast<std::size_t>(step.layer)]);
  set_texture("solid_depth_map", 3, depth_[static_cast<std::size_t>(Layer::Solid)]);
  glUniform1i(place("glass"), glass ? 1 : 0);
  glUniform1i(place("obscurance"), obscurance_ ? 1 : 0);
  glUniform2f(place("tangents"), static_cast<float>(camera_.half_width), static_cast<float>(camera_.half_height));
  glUniform2f(place("depth_of_clip"), view.depth_of_clip[0], view.depth_of_clip[1]);
  set("reach", static_cast<float>(kObscuranceReach) * view.scale);
  set("background_top", unit(palette.background_top));
  set("background_bottom", unit(palette.background_bottom));
  draw_whole_picture();
  glDisable(GL_SCISSOR_TEST);
}

void Painter::resolve() {
  glBindFramebuffer(GL_FRAMEBUFFER, pixels_.get());
  glDisable(GL_BLEND);
  glViewport(0, 0, width_, height_);
  use(resolve_);
  set_texture("light_map", 0, lit_);
  glUniform1i(place("samples"), samples_);
  draw_whole_picture();
}

void Painter::draw_whole_picture() const {
  glBindVertexArray(no_input_.get());
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void Painter::use(const GlProgram& program) {
  program_ = program.get();
  glUseProgram(program_);
}

void Painter::use(const GlProgram& program, const View& view) {
  use(program);
  glUniformMatrix4fv(place("view_from_local"), 1, GL_FALSE, view.view_from_local.data());
  glUniformMatrix4fv(place("clip_from_view"), 1, GL_FALSE, view.clip_from_view.data());
  set("view_scale", view.scale);
}

void Painter::set_texture(const char* name, GLint unit, const GlTexture& texture) const {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_2D, texture.get());
  glUniform1i(place(name), unit);
}

sdk::Expected<Image> read_picture(int width, int height) {
  Image image{.width = width, .height = height, .rgb = {}};
  const std::size_t row = 3 * static_cast<std::size_t>(width);
  image.rgb.resize(row * static_cast<std::size_t>(height));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, image.rgb.data());
  if (const GLenum error = glGetError(); error != GL_NO_ERROR)
    return sdk::fail("OpenGL: error " + std::to_string(error) + " while drawing");
  // OpenGL's first row is the lowest.
  for (auto top = image.rgb.begin(), bottom = image.rgb.end(); top < bottom; top += static_cast<std::ptrdiff_t>(row)) {
    bottom -= static_cast<std::ptrdiff_t>(row);
    if (top < bottom) std::swap_ranges(top, top + static_cast<std::ptrdiff_t>(row), bottom);
  }
  return image;
}

}  // namespace armature::viewer
