#include "viewer/app/photograph.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <numbers>
#include <numeric>
#include <vector>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_impl_opengl3.h>

#include "viewer/app/png.h"

namespace armature::viewer {

namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Draws the pictures of a turn as somebody sees them who turns the camera, and those in which it stands still again.
sdk::Expected<void> time_turn(App& app, Session& session, int pictures, const PictureSize& size, GLuint framebuffer) {
  const auto timed = [&]() -> sdk::Expected<double> {
    ImGui_ImplOpenGL3_NewFrame();
    const auto start = Clock::now();
    if (auto drawn = app.draw(size.width, size.height, framebuffer, false); !drawn)
      return tl::unexpected(drawn.error());
    glFinish();
    return milliseconds_since(start);
  };
  std::vector<double> turning, standing;
  for (int i = 0; i < pictures; ++i) {
    session.camera.orbit(2 * std::numbers::pi / pictures, 0);
    const auto took = timed();
    if (!took) return tl::unexpected(took.error());
    turning.push_back(*took);
  }
  while (app.rough()) {
    const auto took = timed();
    if (!took) return tl::unexpected(took.error());
    standing.push_back(*took);
  }
  std::ranges::sort(turning);
  fmt::print("frame.turning_fastest_ms {:.1f}\nframe.turning_median_ms {:.1f}\nframe.turning_slowest_ms {:.1f}\n",
             turning.front(), turning[turning.size() / 2], turning.back());
  if (!standing.empty())
    fmt::print("frame.standing_ms {:.1f}\nframe.standing_slowest_ms {:.1f}\n",
               std::accumulate(standing.begin(), standing.end(), 0.0), std::ranges::max(standing));
  std::fflush(stdout);
  return {};
}

}  // namespace

sdk::Expected<void> photograph(App& app, Session& session, const PictureRequest& request, const PictureSize& size) {
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
  if (request.turn > 0) return time_turn(app, session, request.turn, size, framebuffer->get());
  const auto image = read_picture(width, height);
  if (!image) return tl::unexpected(image.error());
  return write_png(*image, request.file);
}

}  // namespace armature::viewer
