#include <chrono>
#include <thread>

#include <imgui.h>
#include <imgui_impl_opengl3.h>

#include "viewer/app/app.h"
#include "viewer/app/png.h"
#include "viewer/app/run.h"
#include "viewer/render/gl_context.h"

namespace armature::viewer {
namespace {

/// ImGui's context, for as long as it lives.
struct ImGuiScope {
  ImGuiScope() : context(ImGui::CreateContext()) {}
  ~ImGuiScope() { ImGui::DestroyContext(context); }
  ImGuiScope(const ImGuiScope&) = delete;
  ImGuiScope& operator=(const ImGuiScope&) = delete;
  ImGuiContext* context;
};

/// Frames in memory.
class Studio {
 public:
  static sdk::Expected<Studio> create(Session& session, float scale) {
    auto context = GlContext::create();
    if (!context) return tl::unexpected(context.error());
    Studio studio;
    studio.context_ = std::move(*context);
    studio.imgui_ = std::make_unique<ImGuiScope>();
    auto app = App::create(session, scale);
    if (!app) return tl::unexpected(app.error());
    studio.app_ = std::move(*app);
    return studio;
  }

  sdk::Expected<void> photograph(const std::string& file, int width, int height) {
    GlTexture picture = make_texture(GL_RGBA8, width, height);
    auto framebuffer = make_framebuffer({picture.get()}, 0);
    if (!framebuffer) return tl::unexpected(framebuffer.error());
    ImGui::GetIO().DisplaySize = {static_cast<float>(width), static_cast<float>(height)};
    ImGui::GetIO().DeltaTime = 1.0F / 30;
    // Windows find their size in the first frame and their place in the second.
    for (int frame = 0; frame < 3; ++frame) {
      ImGui_ImplOpenGL3_NewFrame();
      glBindFramebuffer(GL_FRAMEBUFFER, framebuffer->get());
      glDisable(GL_SCISSOR_TEST);
      glClearColor(1, 1, 1, 1);
      glClear(GL_COLOR_BUFFER_BIT);
      if (auto drawn = app_->draw(width, height, framebuffer->get(), true); !drawn) return drawn;
    }
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer->get());
    const auto image = read_picture(width, height);
    if (!image) return tl::unexpected(image.error());
    return write_png(*image, file);
  }

 private:
  Studio() = default;
  std::unique_ptr<GlContext> context_;  // dies last
  std::unique_ptr<ImGuiScope> imgui_;
  std::unique_ptr<App> app_;
};

}  // namespace

sdk::Expected<void> run_headless(Session& session, Script script, const RunOptions& options) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const float scale = options.scale > 0 ? options.scale : 1;
  std::optional<Studio> studio;
  const auto photograph = [&](const std::string& file, int width, int height) -> sdk::Expected<void> {
    if (!studio) {
      auto made = Studio::create(session, scale);
      if (!made) return tl::unexpected(made.error());
      studio.emplace(std::move(*made));
    }
    return studio->photograph(file, width, height);
  };
  session.aspect = static_cast<double>(options.width) / options.height;
  for (;;) {
    session.update(Clock::now() - start);
    if (auto stepped = script.step(session); !stepped) return stepped;
    if (session.picture) {
      const PictureRequest request = *session.picture;
      const int width = request.width > 0 ? request.width : options.width;
      const int height = request.height > 0 ? request.height : options.height;
      if (auto made = photograph(request.file, width, height); !made) return made;
      session.picture.reset();
      continue;
    }
    if (script.done(session) || session.quit) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(4));
  }
  if (session.failed) return sdk::fail(session.notice);
  if (options.screenshot.empty()) return {};
  return photograph(options.screenshot, options.width, options.height);
}

}  // namespace armature::viewer
