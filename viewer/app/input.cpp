// What the mouse and the keys do in the view. The camera moves with Alt, or with the tool that is for looking, and with
// nothing else; a drag stays what it was when it began.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <armature/navproto/nav_camera.h>

#include "viewer/app/ui.h"

namespace armature::viewer {
namespace {

/// Turning by a drag across the whole height of the view.
constexpr float kTurnADrag = 3.5F;
/// Walking by hand.
constexpr double kWalk_m_s = 2.0, kTurn_rad_s = 1.1;

enum class Drag { None, Orbit, Pan, Tool, Walk };

ViewPoint view_point(const Ui& ui, const ImVec2& pixel) {
  const Area& view = ui.view;
  const float half = view.size.y / 2;
  return {(pixel.x - view.at.x - view.size.x / 2) / half, (view.at.y + half - pixel.y) / half};
}

void issue_camera(Ui& ui, const OrbitCamera& c) {
  ui.issue("camera {:.6g} {:.6g} {:.9g} {:.9g} {:.9g} {:.9g}", c.view.azimuth_rad * 180 / std::numbers::pi,
           c.view.elevation_rad * 180 / std::numbers::pi, c.distance, c.target.x(), c.target.y(), c.target.z());
}

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

/// The points of a stroke on the surface, as words; those beside the model are left out.
std::string stroke_on_surface(Ui& ui, std::size_t& count) {
  std::string words;
  count = 0;
  const std::size_t step = std::max<std::size_t>(1, ui.stroke.size() / 64);
  for (std::size_t i = 0; i < ui.stroke.size(); i += step) {
    const auto found = ui.session.pick(view_point(ui, ui.stroke[i]));
    if (!found || !found->face.valid()) continue;
    words += fmt::format(" {:.9g} {:.9g} {:.9g}", found->point.x(), found->point.y(), found->point.z());
    ++count;
  }
  return words;
}

void end_tool_drag(Ui& ui) {
  Session& session = ui.session;
  const ImGuiIO& io = ImGui::GetIO();
  if (session.tool == Tool::Click) {
    const auto found = session.pick(view_point(ui, io.MousePos));
    if (found && found->face.valid()) ui.issue("click {}", found->face.index());
  } else if (session.tool == Tool::Lasso) {
    if (ui.stroke.size() < 3) return;
    std::string words;
    const std::size_t step = std::max<std::size_t>(1, ui.stroke.size() / 128);
    for (std::size_t i = 0; i < ui.stroke.size(); i += step) {
      const ViewPoint at = view_point(ui, ui.stroke[i]);
      words += fmt::format(" {:.5g} {:.5g}", at.x(), at.y());
    }
    issue_camera(ui, session.camera);  // what a loop holds depends on it
    ui.issue("lasso{}", words);
  } else if (session.tool != Tool::Pose) {
    std::size_t count = 0;
    const std::string words = stroke_on_surface(ui, count);
    if (count == 0) {
      session.tell("that stroke was beside the model; begin on it");
    } else if (session.tool == Tool::Cut) {
      ui.issue("cut {}{}", io.KeyShift ? "add" : "new", words);
    } else if (session.tool == Tool::Brush) {
      const double radius = session.brush * 2 * session.around().radius;
      ui.issue("brush {} {:.6g}{}", io.KeyShift ? "add" : io.KeyCtrl ? "background" : "new", radius, words);
    }
  }
}

void handle_mouse(Ui& ui) {
  static Drag drag = Drag::None;
  static int button = 0;
  Session& session = ui.session;
  const ImGuiIO& io = ImGui::GetIO();
  const bool over = ui.view.holds(io.MousePos) && !io.WantCaptureMouse;
  const bool walks = session.mode == Mode::Walk;
  const bool looks = io.KeyAlt || session.tool == Tool::Look;
  if (drag == Drag::None && handle_gizmo(ui, over)) return;
  if (drag == Drag::None && over) {
    for (const int pressed : {0, 1, 2}) {
      if (!io.MouseClicked[pressed]) continue;
      button = pressed;
      if (walks) {
        drag = Drag::Walk;
      } else if (looks && !session.models.empty()) {
        drag = pressed == 0 ? Drag::Orbit : Drag::Pan;
      } else if (pressed == 0 && !session.models.empty()) {
        drag = Drag::Tool;
        ui.stroke = {io.MousePos};
      }
      break;
    }
  }
  const bool moved = io.MouseDelta.x != 0 || io.MouseDelta.y != 0;
  if ((drag == Drag::Orbit || drag == Drag::Pan) && moved) move_camera(ui, drag, io.MouseDelta);
  if (drag == Drag::Tool && moved) ui.stroke.push_back(io.MousePos);
  if (drag != Drag::None && !io.MouseDown[button]) {
    if (drag == Drag::Tool) end_tool_drag(ui);
    ui.stroke.clear();
    drag = Drag::None;
  }
  if (over && io.MouseWheel != 0 && !walks && !session.models.empty()) {
    if (looks) {
      OrbitCamera camera = session.camera;
      camera.zoom(std::pow(1.15, static_cast<double>(io.MouseWheel)));
      issue_camera(ui, camera);
    } else if (session.tool == Tool::Brush) {
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

void handle_keys(Ui& ui) {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantTextInput) return;
  if (io.KeyCtrl) {
    if (ImGui::IsKeyPressed('O', false)) ui.dialog = true, ui.saving = false;
    if (ImGui::IsKeyPressed('Z', false)) ui.issue("{}", io.KeyShift ? "redo" : "undo");
    if (ImGui::IsKeyPressed('Y', false)) ui.issue("redo");
    return;
  }
  if (ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape), false) && ui.session.job.running()) ui.issue("cancel");
  if (ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Tab), false)) ui.sidebar = !ui.sidebar;
  if (ui.session.mode == Mode::Walk) return;
  if (ImGui::IsKeyPressed('F', false) && !ui.session.models.empty()) ui.issue("fit");
  for (int i = 0; i < 5; ++i)
    if (ImGui::IsKeyPressed('1' + i, false)) ui.issue("tool {}", kTools[static_cast<std::size_t>(i)]);
}

}  // namespace

void handle_input(Ui& ui) {
  handle_mouse(ui);
  handle_keys(ui);
  if (ui.session.mode == Mode::Walk) walk_by_hand(ui);
}

}  // namespace armature::viewer
