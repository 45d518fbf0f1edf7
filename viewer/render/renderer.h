#pragma once

#include <memory>

#include <armature/sdk/error.h>

#include "viewer/render/image.h"
#include "viewer/scene/camera.h"
#include "viewer/scene/scene.h"

namespace armature::viewer {

/// Draws scenes into pictures in memory, without a window or a display: depth-tested, spheres and cones ray-cast for
/// every sample, with ambient obscurance and up to nine samples a pixel. The same scene gives the same bytes on the
/// same machine. Used by one thread at a time.
class Renderer {
 public:
  /// Fails with what to install where OpenGL is not available.
  [[nodiscard]] static sdk::Expected<Renderer> create();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();

  /// A picture of width x height pixels; the camera must have been fitted to that aspect. Fails where the card cannot
  /// hold a picture of that size.
  [[nodiscard]] sdk::Expected<Image> draw(const Scene& scene, const Camera& camera, int width, int height);

 private:
  class Implementation;
  explicit Renderer(std::unique_ptr<Implementation> implementation);

  std::unique_ptr<Implementation> implementation_;
};

}  // namespace armature::viewer
