#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <imgui.h>

#include "viewer/session/arguments.h"
#include "viewer/session/session.h"

namespace armature::viewer {

/// A rectangle of the window, in pixels.
struct Area {
  ImVec2 at{0, 0}, size{0, 0};
  [[nodiscard]] ImVec2 end() const { return {at.x + size.x, at.y + size.y}; }
  [[nodiscard]] bool holds(const ImVec2& p) const {
    return p.x >= at.x && p.y >= at.y && p.x < at.x + size.x && p.y < at.y + size.y;
  }
};

/// Of the parts of the window.
inline constexpr ImGuiWindowFlags kFixedWindow =
    ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
    ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus;

struct FileDialog;
struct Gesture;
struct GizmoDrag;

/// The slider of levels of a model: a level may take a while, and the last one that was wanted wins.
struct LevelSlide {
  std::weak_ptr<const Model> model = {};
  int wanted = 0;                      ///< spheres
  bool active = false, waits = false;  ///< whether the mouse holds it; whether `follow_level()` is to issue it
};

/// What a file is chosen for in the dialog.
enum class FileUse : std::uint8_t { Open, Save, SavePose, ReplayPose };

/// What panels share: the session, which they see, and change by commands alone; and what only the window knows.
struct Ui {
  Session& commanded;                  ///< by `issue()` and `tell()`; nobody else changes it
  const Session& session = commanded;  ///< as it is now
  float scale = 1;                     ///< pixels a unit of layout
  Area view = {};                      ///< where the shapes or the city are
  Area beside = {};                    ///< where another model is shown beside; empty if none is
  Area status = {};                    ///< where the status bar is; empty if there is none
  ImTextureID depth = nullptr;         ///< the depth picture, once there is one
  float depth_aspect = 1;

  enum class Drag : std::uint8_t { None, Orbit, Pan, Tool, Walk };
  Drag dragging = Drag::None;                   ///< what the mouse does in the view since a button went down,
  int button = 0;                               ///< which one
  Likeness like_by = Likeness::Gls;             ///< what the next spot is compared by
  bool sidebar = true;                          ///< Tab hides it; a small window has none
  bool dialog = false;                          ///< the file dialog is open
  std::shared_ptr<FileDialog> files = nullptr;  ///< what it remembers
  FileUse file_use = FileUse::Open;             ///< and what for
  bool log = false;                             ///< the list of commands is open
  std::vector<ImVec2> stroke = {};              ///< what the mouse draws at the moment, in pixels
  std::shared_ptr<Gesture> gesture = nullptr;   ///< what it does there; and whether that is still being found
  std::shared_ptr<GizmoDrag> drag = nullptr;    ///< what a handle of a pose is dragged to
  bool following = false;
  LevelSlide slide = {};

  /// Carries a command out; what fails is shown as the session's notice.
  template <class... Args>
  void issue(fmt::format_string<Args...> line, Args&&... args) {
    static_cast<void>(commanded.execute(fmt::format(line, std::forward<Args>(args)...)));
  }
  /// Says why there was nothing to issue; an empty text takes away what was said.
  void tell(std::string text) { commanded.tell(std::move(text)); }
  /// Adds to what the session tells.
  void tell_also(const std::string& text) { commanded.tell(session.notice + text, session.notice_is_error); }
  [[nodiscard]] float px(float units) const { return units * scale; }
};

///@{
/// The parts of the window.
void draw_sidebar(Ui& ui);
void draw_shape_panel(Ui& ui);
void draw_select_panel(Ui& ui);
void draw_sphere_panel(Ui& ui);
void draw_pose_panel(Ui& ui);
void draw_edit_panel(Ui& ui);
void draw_walk_panel(Ui& ui);
void draw_walk_overlay(Ui& ui);
void draw_status_bar(Ui& ui, const Area& area);
void draw_view_hints(Ui& ui);
void draw_file_dialog(Ui& ui);
/// Opens the dialog.
void ask_for_file(Ui& ui, FileUse use);
void draw_log(Ui& ui);
///@}

/// How high the status bar has to be in a window of that width for all that it tells, and for what the mouse does where
/// it says that, too; pixels.
[[nodiscard]] float status_height(const Ui& ui, float width, bool says_what_the_mouse_does);

///@{
/// As much of the end of a text as fits, or all if nothing does: what went wrong stands behind where. Asks a few times.
[[nodiscard]] std::string end_of(const std::string& text, const std::function<bool(const std::string&)>& fits);
/// As much of the beginning of a text as there is room for in a line.
[[nodiscard]] std::string shortened(const std::string& text, float room);
///@}

/// A level's error as people read it: its mean and its largest distance, in percent of the mesh's diagonal.
[[nodiscard]] std::string error_words(const LevelErrors& errors, const char* between);

/// Where things lie over the city; what there is no room for has no size.
struct WalkCards {
  Area mirror, speeds, gauges;
  Area state;        ///< where the sidebar is away,
  std::string said;  ///< in words, as many as there is room for
};
[[nodiscard]] WalkCards place_walk_cards(const Ui& ui);

/// Issues the level that the slider came to, as soon as no work holds it up. Call it once a frame, whether the slider
/// is drawn or not.
void follow_level(Ui& ui);

/// Turns what the mouse and the keys do in the view into commands.
void handle_input(Ui& ui);

/// Shows what is held of a posed shape and lets the mouse move it; whether the mouse is taken by it. `over`: the mouse
/// is over the view.
bool handle_gizmo(Ui& ui, bool over);
/// Shows how what is dragged would lie, as soon as that is found. Call it once a frame; whether there is more to find.
bool follow_gizmo(Ui& ui);

///@{
/// Small things that panels are made of.
void section(const char* title);
/// A row of buttons of which one is chosen; the one that was clicked, or -1.
int choice_row(const char* id, int chosen, const std::vector<const char*>& names);
bool accent_button(const char* label, float width = 0);
/// One that stands in a line of text, and its padding.
bool small_button(const char* label);
ImVec2 small_padding();
void hint(const char* text);
/// What the mouse rests on, the item before, in more words.
void explain(const char* text);
///@}

}  // namespace armature::viewer
