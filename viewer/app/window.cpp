#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <memory>
#include <string>
#include <utility>

#include <epoxy/gl.h>
// After epoxy: it has OpenGL's names.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>
#include <imgui_impl_glfw.h>
#include <imgui_impl_opengl3.h>

#include "viewer/app/app.h"
#include "viewer/app/interrupt.h"
#include "viewer/app/photograph.h"
#include "viewer/app/run.h"

namespace armature::viewer {
namespace {

std::string glfw_complaint() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text != nullptr ? text : "no reason given";
}

/// Processor time of this thread.
Session::Time spent() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

/// Everything that a window needs, taken down in the right order.
struct Window {
  ~Window() {
    app.reset();
    if (backend) ImGui_ImplGlfw_Shutdown();
    if (imgui != nullptr) ImGui::DestroyContext(imgui);
    if (window != nullptr) glfwDestroyWindow(window);
    if (glfw) glfwTerminate();
  }
  bool glfw = false, backend = false;
  GLFWwindow* window = nullptr;
  ImGuiContext* imgui = nullptr;
  std::unique_ptr<App> app;
};

void on_drop(GLFWwindow* window, int count, const char** paths) {
  for (int i = 0; i < count; ++i) static_cast<Playlist*>(glfwGetWindowUserPointer(window))->drop(paths[i]);
}

}  // namespace

sdk::Expected<void> run_window(Session& session, Script script, const RunOptions& options) {
  Window w;
  if (glfwInit() != GLFW_TRUE)
    return sdk::fail("no window can be opened here: " + glfw_complaint() +
                     "; with --screenshot OUT.png the viewer needs no display");
  w.glfw = true;
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, options.scale > 0 ? GLFW_FALSE : GLFW_TRUE);
  w.window = glfwCreateWindow(options.size.width, options.size.height, "Armature", nullptr, nullptr);
  if (w.window == nullptr)
    return sdk::fail("the viewer needs OpenGL 3.3: " + glfw_complaint() +
                     "; a newer graphics driver has it, or Mesa's software driver (on Debian: apt-get install "
                     "libgl1-mesa-dri, then LIBGL_ALWAYS_SOFTWARE=1)");
  glfwSetWindowSizeLimits(w.window, 200, 150, GLFW_DONT_CARE, GLFW_DONT_CARE);
  glfwMakeContextCurrent(w.window);
  glfwSwapInterval(1);
  float scale = options.scale;
  if (!(scale > 0)) glfwGetWindowContentScale(w.window, &scale, nullptr);
  w.imgui = ImGui::CreateContext();
  Playlist playlist(options.files, std::move(script));
  glfwSetWindowUserPointer(w.window, &playlist);
  glfwSetDropCallback(w.window, on_drop);
  w.backend = ImGui_ImplGlfw_InitForOpenGL(w.window, true);
  auto app = App::create(session, scale);
  if (!app) return tl::unexpected(app.error());
  w.app = std::move(*app);

  while (glfwWindowShouldClose(w.window) == GLFW_FALSE && !session.quit && !interrupted()) {
    // Nothing moves: wait for somebody to do something, or for a moment. A short one where something goes on in the
    // background, which needs the processor more.
    if (w.app->calm() && (playlist.done(session) || session.job.running())) {
      glfwWaitEventsTimeout(w.app->awaits() ? 1.0 / 60 : 0.1);
    } else {
      glfwPollEvents();
    }
    const auto begun = std::chrono::steady_clock::now();
    const Session::Time spent_before = spent();
    session.update(std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 * glfwGetTime())));
    int width = 0, height = 0;
    glfwGetFramebufferSize(w.window, &width, &height);
    const bool minimised = width < 16 || height < 16;
    if (!minimised) {
      ImGui_ImplOpenGL3_NewFrame();
      ImGui_ImplGlfw_NewFrame();
      if (auto drawn = w.app->draw(width, height, 0, false); !drawn) return drawn;
    }
    // After the strokes that wait, which are of the model that a file may take the place of.
    playlist.step(session);
    if (minimised) {
      glfwWaitEventsTimeout(1.0 / 60);
      continue;
    }
    session.longest_frame = std::max<Session::Time>(session.longest_frame, std::chrono::steady_clock::now() - begun);
    session.longest_work = std::max(session.longest_work, spent() - spent_before);
    glfwSwapBuffers(w.window);
    if (session.picture) {
      const PictureRequest request = *std::exchange(session.picture, std::nullopt);
      const auto taken = photograph(*w.app, session, request, request.size.value_or(PictureSize{width, height}));
      if (!taken) session.tell_failure(request.origin, taken.error().message);
    }
  }
  return {};
}

}  // namespace armature::viewer
