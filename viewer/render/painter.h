#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

#include <armature/sdk/error.h>

#include "viewer/render/drawing.h"
#include "viewer/render/gl_objects.h"
#include "viewer/render/image.h"
#include "viewer/scene/camera.h"

namespace armature::viewer {

/// How carefully a picture is painted.
struct PaintOptions {
  int samples_a_side = 0;  ///< of a pixel; 0: as many as a picture of that size affords, three at most
  bool obscurance = true;  ///< corners and clefts are darker; else light depends on the normal alone, as in a matcap
  /// Of a drawing with more balls and cones than this its triangles alone, if it has any.
  GLsizei most_ray_cast = std::numeric_limits<GLsizei>::max();
};

/// Paints drawings with the context that is current, into a picture of its own: depth-tested against one another,
/// spheres and cones ray-cast for every sample. Made, used and deleted while that context is current.
class Painter {
 public:
  /// Fails with the driver's complaint.
  [[nodiscard]] static sdk::Expected<Painter> create();

  /// Paints drawings over the first one's background; the camera must have been fitted to that aspect. Leaves
  /// `framebuffer()` bound. Fails where the card cannot hold a picture of that size.
  [[nodiscard]] sdk::Expected<void> paint(std::span<const Drawing* const> drawings, const Camera& camera, int width,
                                          int height, const PaintOptions& options = {});

  ///@{
  /// The same bit by bit, for a caller with something else to do in between: begins, and goes on until `go_on()` says
  /// that the picture is done. Until then the drawings must stay, and the picture before it is still there unless that
  /// had another size. A bit is so small that Mesa's software driver does it in a few hundredths of a second.
  [[nodiscard]] sdk::Expected<void> begin(std::span<const Drawing* const> drawings, const Camera& camera, int width,
                                          int height, const PaintOptions& options);
  bool go_on();
  ///@}

  ///@{
  /// Where the last picture is: sRGB bytes, the lowest row first.
  [[nodiscard]] GLuint framebuffer() const noexcept { return pixels_.get(); }
  [[nodiscard]] GLuint texture() const noexcept { return picture_.get(); }
  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return height_; }
  ///@}

 private:
  struct View;  // the camera as the card takes it, for one drawing
  /// A bit of a picture.
  struct Step {
    enum class Kind : std::uint8_t { Clear, Corners, Balls, Cones, Light, Resolve };
    Kind kind = Kind::Clear;
    Layer layer = Layer::Solid;
    const Drawing* drawing = nullptr;  // for light, the first one
    GLint first = 0;                   // corner, ball, cone, or row of samples,
    GLsizei count = 0;                 // and how many
  };
  Painter() = default;
  sdk::Expected<void> resize(int width, int height, int samples);
  void plan_layer(std::span<const Drawing* const> drawings, Layer layer, GLsizei most_ray_cast);
  void take(const Step& step);
  void clear(Layer layer);
  void draw(const Step& step);
  void light(const Step& step);
  void resolve();
  void draw_whole_picture() const;
  void use(const GlProgram& program);
  void use(const GlProgram& program, const View& view);
  [[nodiscard]] GLint place(const char* name) const { return glGetUniformLocation(program_, name); }
  void set(const char* name, float value) const { glUniform1f(place(name), value); }
  void set(const char* name, const std::array<float, 3>& value) const { glUniform3fv(place(name), 1, value.data()); }
  void set_texture(const char* name, GLint unit, const GlTexture& texture) const;

  GlProgram triangles_, balls_, cones_, light_, resolve_;
  GLuint program_ = 0;  // the one in use
  std::vector<Step> steps_;
  std::size_t done_ = 0;  // how many of them
  Camera camera_;
  bool obscurance_ = true;
  GlVertexArray no_input_;
  int width_ = 0, height_ = 0, samples_ = 1;
  GlTexture albedo_, normal_, lit_, picture_;
  std::array<GlTexture, 2> depth_;         // by Layer
  std::array<GlFramebuffer, 2> surfaces_;  // by Layer: albedo, normal, depth
  GlFramebuffer lights_, pixels_;
};

/// What the framebuffer that is bound shows. Fails where OpenGL reports an error, of now or of before.
[[nodiscard]] sdk::Expected<Image> read_picture(int width, int height);

}  // namespace armature::viewer
