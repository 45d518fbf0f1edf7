#include "viewer/app/photograph.h"

#include <imgui.h>
#include <imgui_impl_opengl3.h>

#include "viewer/app/png.h"

namespace armature::viewer {

sdk::Expected<void> photograph(App& app, const std::string& file, const PictureSize& size) {
  const auto [width, height] = size;
  GlTexture picture = make_texture(GL_RGBA8, width, height);
  auto framebuffer = make_framebuffer({picture.get()}, 0);
  if (!framebuffer) return tl::unexpected(framebuffer.error());
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = {static_cast<float>(width), static_cast<float>(height)};
  io.DisplayFramebufferScale = {1, 1};
  io.DeltaTime = 1.0F / 30;
  // Windows find their size in the first frame and their place in the second.
  for (int frame = 0; frame < 3; ++frame) {
    ImGui_ImplOpenGL3_NewFrame();
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer->get());
    glDisable(GL_SCISSOR_TEST);
    glClearColor(1, 1, 1, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    if (auto drawn = app.draw(width, height, framebuffer->get(), true); !drawn) return drawn;
  }
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer->get());
  const auto image = read_picture(width, height);
  if (!image) return tl::unexpected(image.error());
  return write_png(*image, file);
}

}  // namespace armature::viewer
