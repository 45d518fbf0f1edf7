#include "viewer/app/app.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <imgui_impl_opengl3.h>

#include "viewer/app/theme.h"

namespace armature::viewer {
namespace {

constexpr float kSidebar = 290;
/// A smaller view than this is not worth a sidebar.
constexpr float kLeastView = 300, kLeastHeight = 240;

}  // namespace

App::App(Session& session, float scale, ViewPainter painter)
    : session_(session), ui_{.commanded = session, .scale = scale}, painter_(std::move(painter)) {}

App::~App() {
  ImGui_ImplOpenGL3_Shutdown();
}

sdk::Expected<std::unique_ptr<App>> App::create(Session& session, float scale) {
  auto painter = ViewPainter::create();
  if (!painter) return tl::unexpected(painter.error());
  theme::apply(scale);
  ImGui::GetIO().IniFilename = nullptr;  // nothing is stored that nobody asked for
  if (!ImGui_ImplOpenGL3_Init("#version 330 core"))
    return sdk::fail("OpenGL: the window's panels cannot be drawn (on Debian: apt-get install libgl1)");
  return std::unique_ptr<App>(new App(session, scale, std::move(*painter)));
}

/// A small window shows the view alone.
void App::lay_out(int width, int height) {
  const auto w = static_cast<float>(width), h = static_cast<float>(height);
  const float sidebar = ui_.px(kSidebar);
  const bool has_room = w >= sidebar + ui_.px(kLeastView) && h >= ui_.px(kLeastHeight);
  const bool has_to_tell = session_.notice_is_error && !session_.notice.empty();
  const bool is_small = h < ui_.px(kLeastHeight);
  const float status = std::round(std::min(status_height(ui_, w, !is_small), 0.75F * h));
  // Work that takes long is told over a small view, which keeps its size.
  const float below = has_to_tell || !is_small ? status : 0;
  ui_.status = below > 0 || session_.job.running() ? Area{{0, h - status}, {w, status}} : Area{};
  const float left = has_room && ui_.sidebar ? std::round(sidebar) : 0;
  ui_.view = {{left, 0}, {std::max(16.F, w - left), std::max(16.F, h - below)}};
  ui_.beside = {};
  session_.aspect = static_cast<double>(ui_.view.size.x / ui_.view.size.y);
  if (session_.mode == Mode::Shapes && session_.other() != nullptr) {
    const float half = std::round(ui_.view.size.x / 2);
    ui_.beside = {{ui_.view.at.x + half, 0}, {ui_.view.size.x - half, ui_.view.size.y}};
    ui_.view.size.x = half;
  }
}

/// Over a view: a model's name, as much of it as there is room for, and the error of its level.
void App::draw_name(const Area& area, const Model& model) const {
  const float room = area.size.x - ui_.px(28);
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  const ImVec2 at{area.at.x + ui_.px(14), ui_.px(12)};
  draw.AddText(at, theme::kInk, shortened(model.name, room).c_str());
  if (!model.mesh || model.posing || !model.spheres || !model.spheres->errors) return;
  const std::string error = error_words(*model.spheres->errors, "\n");
  draw.AddText(ImGui::GetFont(), ImGui::GetFontSize(), {at.x, at.y + ImGui::GetTextLineHeightWithSpacing()},
               theme::kDim, error.c_str(), nullptr, room);
}

/// Depth in greys, nearer is lighter; whoever steers in the accent's colour.
void App::update_depth() {
  const auto feed = session_.mode == Mode::Walk ? session_.walk.feed() : nullptr;
  if (feed == shown_depth_) return;
  shown_depth_ = feed;
  if (!feed) {
    ui_.depth = nullptr;
    return;
  }
  const int width = feed->intrinsics.width, height = feed->intrinsics.height;
  std::vector<std::uint8_t> rgb;
  rgb.reserve(3 * feed->depth_mm.size());
  for (std::size_t i = 0; i < feed->depth_mm.size(); ++i) {
    const int depth = feed->depth_mm[i];
    const int grey = depth == 0 ? 40 : std::clamp(170 - depth / 36, 52, 160);
    const bool user = i < feed->user_mask.size() && feed->user_mask[i] != 0;
    const int light = depth == 0 ? 120 : std::clamp(330 - depth / 14, 90, 255);
    if (user) {
      rgb.insert(rgb.end(), {static_cast<std::uint8_t>(light * 36 / 255), static_cast<std::uint8_t>(light * 130 / 255),
                             static_cast<std::uint8_t>(light * 225 / 255)});
    } else {
      rgb.insert(rgb.end(), 3, static_cast<std::uint8_t>(grey));
    }
  }
  if (depth_.get() == 0) {
    GLuint name = 0;
    glGenTextures(1, &name);
    depth_ = GlTexture(name);
  }
  glBindTexture(GL_TEXTURE_2D, depth_.get());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, width, height, 0, GL_RGB, GL_UNSIGNED_BYTE, rgb.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  // NOLINTNEXTLINE(performance-no-int-to-ptr): ImGui's type of a texture.
  ui_.depth = reinterpret_cast<ImTextureID>(static_cast<std::intptr_t>(depth_.get()));
  ui_.depth_aspect = static_cast<float>(width) / static_cast<float>(std::max(1, height));
}

/// Paints a model where it is to be in the window.
sdk::Expected<void> App::draw_view(ViewPainter& painter, const std::shared_ptr<const Model>& model, const Area& area,
                                   int height, GLuint framebuffer, bool careful) {
  const int wide = static_cast<int>(area.size.x), high = static_cast<int>(area.size.y);
  if (auto painted = painter.paint(session_, model, wide, high, careful); !painted) return painted;
  if (const auto complaint = painter.take_complaint()) session_.tell("drawing: " + *complaint, true);
  const Painter& picture = painter.picture();
  glBindFramebuffer(GL_READ_FRAMEBUFFER, picture.framebuffer());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
  const int left = static_cast<int>(area.at.x);
  // OpenGL counts rows from below: the status bar is under the view.
  const int below = height - high;
  glDisable(GL_SCISSOR_TEST);
  glBlitFramebuffer(0, 0, picture.width(), picture.height(), left, below, left + wide, below + high,
                    GL_COLOR_BUFFER_BIT, picture.width() == wide ? GL_NEAREST : GL_LINEAR);
  return {};
}

sdk::Expected<void> App::draw(int width, int height, GLuint framebuffer, bool careful) {
  ImGui::NewFrame();
  lay_out(width, height);
  handle_input(ui_);
  update_depth();
  draw_view_hints(ui_);
  if (session_.mode == Mode::Walk) draw_walk_overlay(ui_);
  if (ui_.view.at.x > 0) draw_sidebar(ui_);
  follow_level(ui_);
  lay_out(width, height);  // again: the sidebar may have closed a model
  if (ui_.beside.size.x > 0) {
    draw_name(ui_.view, *session_.models[session_.active_model]);
    draw_name(ui_.beside, *session_.other());
  }
  if (ui_.status.size.y > 0) draw_status_bar(ui_, ui_.status);
  if (ui_.log) draw_log(ui_);
  if (ui_.dialog) draw_file_dialog(ui_);
  ImGui::Render();

  const auto active = session_.models.empty() ? nullptr : session_.models[session_.active_model];
  if (auto drawn = draw_view(painter_, active, ui_.view, height, framebuffer, careful); !drawn) return drawn;
  if (ui_.beside.size.x > 0) {
    if (!beside_) {
      auto made = ViewPainter::create();
      if (!made) return tl::unexpected(made.error());
      beside_.emplace(std::move(*made));
    }
    const auto& other = session_.models[session_.beside - 1];
    if (auto drawn = draw_view(*beside_, other, ui_.beside, height, framebuffer, careful); !drawn) return drawn;
  } else if (beside_) {
    beside_->rest();
    if (!beside_->making()) beside_.reset();  // its job would be waited for
  }
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, width, height);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  const GLenum error = glGetError();
  if (error == GL_OUT_OF_MEMORY) {
    // Nobody's work is lost for that.
    session_.tell("the graphics card has not enough memory to draw all of this; close other models", true);
  } else if (error != GL_NO_ERROR)
    return sdk::fail("OpenGL: error " + std::to_string(error) + " while drawing");
  return {};
}

bool App::calm() const noexcept {
  const auto paints = [](const ViewPainter& painter) { return painter.rough() && !painter.awaits(); };
  return !paints(painter_) && !(beside_ && paints(*beside_)) && session_.mode == Mode::Shapes;
}

bool App::awaits() const noexcept {
  return session_.busy() || ui_.following || painter_.awaits() || (beside_ && beside_->awaits());
}

}  // namespace armature::viewer
