// What the mouse and the keys do in the view. The camera moves with Alt, or with the tool that is for looking, and with
// nothing else; a drag stays what it was when it began.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <armature/navproto/nav_camera.h>

#include "viewer/app/gestures.h"

namespace armature::viewer {
namespace {

/// Turning by a drag across the whole height of the view.
constexpr float kTurnADrag = 3.5F;
/// Walking by hand.
constexpr double kWalk_m_s = 2.0, kTurn_rad_s = 1.1;

using Drag = Ui::Drag;

void move_camera(Ui& ui, Drag drag, const ImVec2& by) {
  OrbitCamera camera = ui.session.camera;
  const float share = 1 / ui.view.size.y;
  if (drag == Drag::Orbit) {
    camera.orbit(static_cast<double>(-kTurnADrag * by.x * share), static_cast<double>(kTurnADrag * by.y * share));
  } else {
    camera.pan({2.0 * static_cast<double>(by.x * share), -2.0 * static_cast<double>(by.y * share)});
  }
  issue_camera(ui, camera);
}

void handle_mouse(Ui& ui) {
  Drag& drag = ui.dragging;
  const Session& session = ui.session;
  const ImGuiIO& io = ImGui::GetIO();
  const bool over = ui.view.holds(io.MousePos) && !io.WantCaptureMouse;
  // The camera is one for both models; tools work on the left one.
  const bool over_either = over || (ui.beside.holds(io.MousePos) && !io.WantCaptureMouse);
  const bool walks = session.mode == Mode::Walk;
  const bool looks = io.KeyAlt || session.tool == Tool::Look;
  if (drag == Drag::None && handle_gizmo(ui, over)) return;
  if (drag == Drag::None && over_either) {
    for (const int pressed : {0, 1, 2}) {
      if (!io.MouseClicked[pressed]) continue;
      ui.button = pressed;
      if (walks) {
        drag = Drag::Walk;
      } else if (looks && !session.models.empty()) {
        drag = pressed == 0 ? Drag::Orbit : Drag::Pan;
      } else if (pressed == 0 && over && !session.models.empty()) {
        drag = Drag::Tool;
        begin_gesture(ui);
      }
      break;
    }
  }
  const bool moved = io.MouseDelta.x != 0 || io.MouseDelta.y != 0;
  if ((drag == Drag::Orbit || drag == Drag::Pan) && moved) move_camera(ui, drag, io.MouseDelta);
  if (drag == Drag::Tool && moved) continue_gesture(ui);
  if (drag != Drag::None && !io.MouseDown[ui.button]) {
    if (drag == Drag::Tool) end_gesture(ui);
    drag = Drag::None;
  }
  if (over_either && io.MouseWheel != 0 && !walks && !session.models.empty()) {
    if (looks) {
      OrbitCamera camera = session.camera;
      camera.zoom(std::pow(1.15, static_cast<double>(io.MouseWheel)));
      issue_camera(ui, camera);
    } else if (over && session.tool == Tool::Brush) {
      ui.issue("brush-size {:.4g}",
               std::clamp(session.brush * std::pow(1.1, static_cast<double>(io.MouseWheel)), 0.002, 0.5));
    }
  }
  // The brush's size, where it is.
  if (over && !walks && !looks && session.tool == Tool::Brush && !session.models.empty()) {
    const auto radius = static_cast<float>(session.brush * 2 * session.around().radius /
                                           (OrbitCamera::kHalfHeight * session.camera.distance) * ui.view.size.y / 2);
    ImGui::GetBackgroundDrawList()->AddCircle(io.MousePos, radius, IM_COL32(36, 104, 188, 255), 0, ui.px(1.5F));
  }
}

bool down(int key) {
  return key >= 0 && key < 512 && ImGui::GetIO().KeysDown[key];
}

/// By keys or by a drag: up and down walk, left and right turn.
void walk_by_hand(Ui& ui) {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantTextInput || io.KeyCtrl) return;
  const auto held = [](char letter, ImGuiKey arrow) { return down(letter) || down(ImGui::GetKeyIndex(arrow)) ? 1 : 0; };
  navproto::Velocity hands;
  hands.linear_m_s = kWalk_m_s * (held('W', ImGuiKey_UpArrow) - held('S', ImGuiKey_DownArrow));
  hands.angular_rad_s = kTurn_rad_s * (held('A', ImGuiKey_LeftArrow) - held('D', ImGuiKey_RightArrow));
  if (!io.WantCaptureMouse && io.MouseDown[0] && ui.view.holds(io.MouseClickedPos[0])) {
    const ImVec2 from = io.MouseClickedPos[0];
    hands.linear_m_s +=
        std::clamp(4.0 * static_cast<double>((from.y - io.MousePos.y) / ui.view.size.y), -1.0, 1.0) * 2 * kWalk_m_s;
    hands.angular_rad_s +=
        std::clamp(4.0 * static_cast<double>((from.x - io.MousePos.x) / ui.view.size.y), -1.0, 1.0) * kTurn_rad_s;
  }
  if (hands == navproto::Velocity{}) return;
  navproto::NavCamera camera(ui.session.walk.pose());
  camera.advance(hands, std::chrono::duration<double>(static_cast<double>(std::min(io.DeltaTime, 0.1F))));
  const auto& pose = camera.pose();
  ui.issue("place {:.6g} {:.6g} {:.6g}", pose.x_m, pose.y_m, pose.heading_rad * 180 / std::numbers::pi);
}

/// What was done last on the page that is seen; there is nothing of it in the city.
void take_back_or_do_again(Ui& ui, bool again) {
  if (ui.session.mode == Mode::Walk) return;
  if (ui.session.panel != Panel::Edit) {
    ui.issue("{}", again ? "redo" : "undo");
  } else if (!again) {
    const auto& models = ui.session.models;
    const bool tries = !models.empty() && models[ui.session.active_model]->editing.tried;
    ui.issue("{}", tries ? "drop-edit" : "undo-edit");
  }
}

void handle_keys(Ui& ui) {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantTextInput) return;
  if (io.KeyCtrl) {
    if (ImGui::IsKeyPressed('O', false)) ask_for_file(ui, FileUse::Open);
    if (ImGui::IsKeyPressed('S', false) && !ui.session.models.empty()) ask_for_file(ui, FileUse::Save);
    if (ImGui::IsKeyPressed('Z', false)) take_back_or_do_again(ui, io.KeyShift);
    if (ImGui::IsKeyPressed('Y', false)) take_back_or_do_again(ui, true);
    return;
  }
  if (ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape), false) && ui.session.job.running() &&
      !ui.session.job.whole())
    ui.issue("cancel");
  if (ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Tab), false)) ui.sidebar = !ui.sidebar;
  if (ui.session.mode == Mode::Walk) return;
  if (ImGui::IsKeyPressed('F', false) && !ui.session.models.empty()) ui.issue("fit");
  for (int i = 0; i < 6; ++i)
    if (ImGui::IsKeyPressed('1' + i, false)) ui.issue("tool {}", kTools[static_cast<std::size_t>(i)]);
  if (ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Enter), false) && ui.session.panel == Panel::Select &&
      !ui.session.models.empty() && ui.session.models[ui.session.active_model]->selecting.expansion)
    ui.issue("take");
}

}  // namespace

void handle_input(Ui& ui) {
  handle_mouse(ui);
  ui.following = follow_gesture(ui);
  handle_keys(ui);
  if (ui.session.mode == Mode::Walk) walk_by_hand(ui);
}

}  // namespace armature::viewer
