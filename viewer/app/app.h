#pragma once

#include <memory>
#include <optional>
#include <string>

#include "viewer/app/ui.h"
#include "viewer/app/view_painter.h"
#include "viewer/session/script.h"

namespace armature::viewer {

/// The whole of a window's contents, drawn into whatever framebuffer there is; with a window or without. Made, used and
/// deleted while its context is current and ImGui has one.
class App {
 public:
  /// `scale`: pixels a unit of layout. Fails where OpenGL does.
  [[nodiscard]] static sdk::Expected<std::unique_ptr<App>> create(Session& session, float scale);
  ~App();
  App(const App&) = delete;
  App& operator=(const App&) = delete;

  /// Draws a frame of that many pixels into `framebuffer`, after ImGui's backends have begun theirs. `careful`: for a
  /// picture, not for someone who waits. Fails where OpenGL does.
  [[nodiscard]] sdk::Expected<void> draw(int width, int height, GLuint framebuffer, bool careful);
  /// Whether the picture is rougher than it is once nothing moves.
  [[nodiscard]] bool rough() const noexcept { return painter_.rough() || (beside_ && beside_->rough()); }
  /// Whether the next frame would look the same if nobody does anything and nothing goes on in the background,
  [[nodiscard]] bool calm() const noexcept;
  /// as it does where something is being made that is to be shown.
  [[nodiscard]] bool awaits() const noexcept;

 private:
  App(Session& session, float scale, ViewPainter painter);
  void lay_out(int width, int height);
  void draw_name(const Area& area, const Model& model) const;
  void update_depth();
  [[nodiscard]] sdk::Expected<void> draw_view(ViewPainter& painter, const std::shared_ptr<const Model>& model,
                                              const Area& area, int height, GLuint framebuffer, bool careful);

  Session& session_;
  Ui ui_;
  ViewPainter painter_;
  std::optional<ViewPainter> beside_;  // once it was wanted
  GlTexture depth_;
  std::shared_ptr<const navproto::FeedMessage> shown_depth_;
};

}  // namespace armature::viewer
