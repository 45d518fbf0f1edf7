#include <chrono>
#include <thread>
#include <utility>

#include <imgui.h>

#include "viewer/app/interrupt.h"
#include "viewer/app/photograph.h"
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

  [[nodiscard]] App& app() noexcept { return *app_; }

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
  const auto take = [&](const PictureRequest& request) -> sdk::Expected<void> {
    if (!studio) {
      auto made = Studio::create(session, scale);
      if (!made) return tl::unexpected(made.error());
      studio.emplace(std::move(*made));
    }
    return photograph(studio->app(), session, request, request.size.value_or(options.size));
  };
  session.aspect = static_cast<double>(options.size.width) / options.size.height;
  Script all;
  for (const std::string& file : options.files) all.append(Script({"open " + as_word(file)}));
  all.append(std::move(script));
  for (;;) {
    if (interrupted()) return sdk::fail("interrupted");
    session.update(Clock::now() - start);
    if (auto stepped = all.step(session); !stepped) return stepped;
    if (session.picture) {
      const PictureRequest request = *std::exchange(session.picture, std::nullopt);
      if (const auto taken = take(request); !taken) session.tell_failure(request.origin, taken.error().message);
      continue;
    }
    if (all.done(session) || session.quit) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(4));
  }
  if (session.failure) return sdk::fail(*session.failure);
  if (options.screenshot.empty()) return {};
  return take({.file = options.screenshot});
}

}  // namespace armature::viewer
