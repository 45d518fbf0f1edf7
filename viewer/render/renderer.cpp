#include "viewer/render/renderer.h"

#include <array>
#include <cassert>
#include <utility>

#include "viewer/render/gl_context.h"
#include "viewer/render/painter.h"

namespace armature::viewer {

class Renderer::Implementation {
 public:
  Implementation(std::unique_ptr<GlContext> context, Painter painter)
      : context_(std::move(context)), painter_(std::move(painter)) {}
  ~Implementation() { static_cast<void>(context_->make_current()); }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  [[nodiscard]] sdk::Expected<Image> draw(const Scene& scene, const Camera& camera, int width, int height) {
    if (!context_->make_current()) return sdk::fail("OpenGL: the context is in use by another thread");
    const Drawing drawing(scene);
    const std::array<const Drawing*, 1> drawings = {&drawing};
    if (auto painted = painter_.paint(drawings, camera, width, height); !painted)
      return tl::unexpected(painted.error());
    return read_picture(width, height);
  }

 private:
  std::unique_ptr<GlContext> context_;  // first: the rest dies before it
  Painter painter_;
};

Renderer::Renderer(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

sdk::Expected<Renderer> Renderer::create() {
  auto context = GlContext::create();
  if (!context) return tl::unexpected(context.error());
  auto painter = Painter::create();
  if (!painter) return tl::unexpected(painter.error());
  return Renderer(std::make_unique<Implementation>(std::move(*context), std::move(*painter)));
}

sdk::Expected<Image> Renderer::draw(const Scene& scene, const Camera& camera, int width, int height) {
  assert(width > 0 && height > 0);
  return implementation_->draw(scene, camera, width, height);
}

}  // namespace armature::viewer
