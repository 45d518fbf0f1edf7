// The panel on the left: what to do, and the panel for it.
#include <algorithm>
#include <array>
#include <optional>

#include "viewer/app/theme.h"
#include "viewer/app/ui.h"

namespace armature::viewer {
namespace {

void draw_models(Ui& ui) {
  const Session& session = ui.session;
  if (ImGui::Button("Open...")) ask_for_file(ui, FileUse::Open);
  explain("Ctrl+O");
  if (session.models.empty()) {
    hint("Or drop a file onto the window: a mesh (OFF, OBJ, PLY, STL), a sphere-mesh (.ma) or a hierarchy (.smh).");
    return;
  }
  ImGui::SameLine();
  if (ImGui::Button("Save as...")) ask_for_file(ui, FileUse::Save);
  explain("Ctrl+S");
  ImGui::SameLine();
  if (ImGui::Button("Close")) ui.issue("close");
  if (session.models.size() > 1) {
    bool beside = session.other() != nullptr;
    if (ImGui::Checkbox("Side by side", &beside))
      ui.issue("beside {}", !beside ? 0 : session.active_model > 0 ? session.active_model : 2);
  }
  for (std::size_t i = 0; i < session.models.size(); ++i) {
    const Model& model = *session.models[i];
    ImGui::PushID(static_cast<int>(i));
    if (ImGui::Selectable(model.name.c_str(), i == session.active_model) && i != session.active_model)
      ui.issue("model {}", i + 1);
    ImGui::PopID();
    if (ImGui::IsItemHovered() && !model.path.empty()) ImGui::SetTooltip("%s", model.path.c_str());
  }
}

void draw_panel(Ui& ui) {
  const Model& model = *ui.session.models[ui.session.active_model];
  switch (ui.session.panel) {
    case Panel::Look: return draw_shape_panel(ui);
    case Panel::Spheres:
      draw_sphere_panel(ui);
      if (model.mesh && model.spheres) draw_pose_panel(ui);
      return;
    case Panel::Select: return draw_select_panel(ui);
    case Panel::Edit: return draw_edit_panel(ui);
  }
}

}  // namespace

void draw_sidebar(Ui& ui) {
  const Session& session = ui.session;
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize({ui.view.at.x, ui.view.size.y});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
  ImGui::Begin("sidebar", nullptr, kFixedWindow);
  ImGui::PopStyleVar();
  const int mode = choice_row("mode", static_cast<int>(session.mode), {"Shapes", "Walk"});
  if (mode >= 0) ui.issue("mode {}", kModes[static_cast<std::size_t>(mode)]);
  if (session.mode == Mode::Walk) {
    draw_walk_panel(ui);
  } else {
    ImGui::Spacing();
    draw_models(ui);
    if (!session.models.empty()) {
      ImGui::Spacing();
      const int panel = choice_row("panel", static_cast<int>(session.panel), {"Look", "Spheres", "Select", "Edit"});
      if (panel >= 0) ui.issue("panel {}", kPanels[static_cast<std::size_t>(panel)]);
      draw_panel(ui);
    }
  }
  ImGui::Dummy({0, ui.px(8)});
  if (small_button(ui.log ? "Hide the commands" : "Commands")) ui.log = !ui.log;
  ImGui::End();
}

void draw_log(Ui& ui) {
  const Area& view = ui.view;
  const float height = std::min(ui.px(190), 0.5F * view.size.y);
  ImGui::SetNextWindowPos({view.at.x + ui.px(12), view.end().y - height - ui.px(12)});
  ImGui::SetNextWindowSize({std::min(ui.px(520), view.size.x - ui.px(24)), height});
  ImGui::Begin("Commands", &ui.log, kFixedWindow);
  hint("Every action is a line; armature-viewer --script FILE replays them.");
  if (small_button("Copy all")) {
    std::string text;
    for (const std::string& line : ui.session.log()) text += line + '\n';
    ImGui::SetClipboardText(text.c_str());
  }
  ImGui::SameLine();
  if (small_button("Save to session.txt")) ui.issue("save-session session.txt");
  ImGui::BeginChild("lines");
  for (const std::string& line : ui.session.log()) ImGui::TextUnformatted(line.c_str());
  if (ImGui::GetScrollY() >= ImGui::GetScrollMaxY()) ImGui::SetScrollHereY(1);
  ImGui::EndChild();
  ImGui::End();
}

namespace {

/// Where a match is seen, as near to its middle as can be; nothing where something else hides it.
std::optional<ViewPoint> place_of(const Session& session, const sdk::Mesh& mesh, const sdk::Match& match) {
  constexpr std::size_t kLooks = 24;
  const auto middle_of = [&](sdk::FaceId face) -> Eigen::Vector3d {
    return (mesh.corner(face, 0) + mesh.corner(face, 1) + mesh.corner(face, 2)) / 3;
  };
  const std::size_t step = std::max<std::size_t>(1, match.faces.size() / kLooks);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  std::vector<ViewPoint> looks;
  for (std::size_t i = 0; i < match.faces.size(); i += step) {
    const Eigen::Vector3d point = middle_of(match.faces[i]);
    middle += point;
    looks.push_back(session.camera.project(point));
  }
  const ViewPoint centre = session.camera.project(middle / static_cast<double>(looks.size()));
  looks.push_back(centre);
  std::optional<ViewPoint> best;
  for (const ViewPoint& at : looks) {
    if (best && (*best - centre).norm() <= (at - centre).norm()) continue;
    const auto seen = session.pick(at);
    if (seen && std::ranges::binary_search(match.faces, seen->face)) best = at;
  }
  return best;
}

/// The numbers of the list's matches, where they are seen.
void draw_match_numbers(Ui& ui, ImDrawList& draw) {
  const Session& session = ui.session;
  if (session.mode != Mode::Shapes || session.models.empty()) return;
  const Model& model = *session.models[session.active_model];
  const auto& selecting = model.selecting;
  if (!model.mesh || !selecting.expansion || session.panel != Panel::Select || session.job.running()) return;
  constexpr std::size_t kMost = 30;
  std::size_t place = 0;
  for (const sdk::Match& match : selecting.expansion->first(std::min(selecting.shown, kMost))) {
    const std::string number = std::to_string(++place);
    const auto at = place_of(session, model.mesh->mesh, match);
    if (!at) continue;
    const float half = ui.view.size.y / 2;
    const ImVec2 centre(ui.view.at.x + ui.view.size.x / 2 + half * static_cast<float>(at->x()),
                        ui.view.at.y + half * (1 - static_cast<float>(at->y())));
    if (!ui.view.holds(centre)) continue;
    const ImVec2 size = ImGui::CalcTextSize(number.c_str());
    draw.AddCircleFilled(centre, ui.px(11), theme::kVeil);
    draw.AddText({centre.x - size.x / 2, centre.y - size.y / 2}, theme::kInk, number.c_str());
  }
}

}  // namespace

void draw_view_hints(Ui& ui) {
  const Session& session = ui.session;
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  if (session.mode == Mode::Shapes && session.models.empty() && !session.job.running()) {
    const float room = ui.view.size.x - ui.px(24);
    struct Line {
      const char* text;
      ImU32 colour;
      ImFont* font;
    };
    std::array<Line, 2> lines = {{{"Open a model, or drop one here", theme::kInk, theme::large()},
                                  {ui.view.at.x > 0 ? "or choose Walk to go through a city"
                                   : ui.sidebar     ? "A larger window shows what can be done."
                                                    : "Tab shows what can be done.",
                                   theme::kDim, ImGui::GetFont()}}};
    const auto size_of = [&](const Line& line, float wrap) {
      return line.font->CalcTextSizeA(line.font->FontSize, 1e9F, wrap, line.text);
    };
    if (size_of(lines[0], 0).x > room) lines[0].font = ImGui::GetFont();
    const float high = size_of(lines[0], room).y + ui.px(8) + size_of(lines[1], room).y;
    float y = ui.view.at.y + std::max(0.F, 0.48F * (ui.view.size.y - high));
    for (const Line& line : lines) {
      const ImVec2 size = size_of(line, room);
      draw.AddText(line.font, line.font->FontSize, {ui.view.at.x + (ui.view.size.x - size.x) / 2, y}, line.colour,
                   line.text, nullptr, room);
      y += size.y + ui.px(8);
    }
  }
  draw_match_numbers(ui, draw);
  const bool strokes = session.tool == Tool::Cut || session.tool == Tool::Brush || session.tool == Tool::Lasso;
  if (strokes && ui.stroke.size() > 1) {
    const bool loop = session.tool == Tool::Lasso;
    draw.AddPolyline(ui.stroke.data(), static_cast<int>(ui.stroke.size()), theme::kAccent,
                     loop ? ImDrawFlags_Closed : ImDrawFlags_None, ui.px(2.5F));
  }
}

}  // namespace armature::viewer
