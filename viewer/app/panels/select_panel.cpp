// Selecting regions, and all that are like them.
#include <algorithm>
#include <array>

#include "viewer/app/theme.h"
#include "viewer/app/ui.h"

namespace armature::viewer {
namespace {

void draw_tools(Ui& ui) {
  const Session& session = ui.session;
  const int tool =
      choice_row("tool", static_cast<int>(session.tool), {"Look", "Click", "Cut", "Brush", "Lasso", "Edge"});
  if (tool >= 0) ui.issue("tool {}", kTools[static_cast<std::size_t>(tool)]);
  if (session.tool == Tool::Pose || session.tool == Tool::Edge || session.tool == Tool::Spot) return;
  if (session.tool == Tool::Look) {
    hint("The mouse moves the camera. Choose a tool to select; with Alt the mouse moves the camera then, too.");
    return;
  }
  if (session.tool == Tool::Brush) {
    auto size = static_cast<float>(100 * session.brush);
    ImGui::SetNextItemWidth(-1);
    if (ImGui::SliderFloat("##brush", &size, 0.5F, 20, "brush %.1f %%", ImGuiSliderFlags_Logarithmic))
      ui.issue("brush-size {:.4g}", size / 100);
  }
  const int combine = choice_row("combine", static_cast<int>(session.combine), {"New", "Add", "Minus", "Both"});
  if (combine >= 0) ui.issue("combine {}", kCombines[static_cast<std::size_t>(combine)]);
  static constexpr std::array<const char*, 4> kMeaning = {
      "A gesture selects anew.", "A gesture adds to what is selected.", "A gesture takes away from what is selected.",
      "What a gesture and the selection share stays selected."};
  hint(kMeaning[static_cast<std::size_t>(session.combine)]);
}

/// A match: its place, how much it is alike, and two buttons; below them, why.
void draw_match(Ui& ui, std::size_t place, const sdk::Match& match, bool shown) {
  ImGui::PushID(static_cast<int>(place));
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, small_padding());
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {ImGui::GetStyle().ItemSpacing.x, 0});
  ImGui::AlignTextToFramePadding();
  if (!shown) ImGui::PushStyleColor(ImGuiCol_Text, theme::kDim);
  ImGui::Text("%zu", place);
  ImGui::SameLine(ui.px(42));
  ImGui::Text("%.0f %%", 100 * match.score);
  if (!shown) ImGui::PopStyleColor();
  ImGui::SameLine(ui.px(92));
  if (small_button("Yes")) ui.issue("accept {}", place);
  explain("It is like it: what resembles this one rises in the list");
  ImGui::SameLine();
  if (small_button("No")) ui.issue("reject {}", place);
  explain("It is not: it goes, and what resembles it falls");
  ImGui::SameLine();
  ImGui::TextDisabled("%s", match.mirrored ? "mirrored" : "");
  ImGui::PopStyleVar(2);
  const float indent = ui.px(28);
  ImGui::Indent(indent);
  hint(match.reason.c_str());
  ImGui::Unindent(indent);
  ImGui::PopID();
}

void draw_expansion(Ui& ui, const Selecting& selecting) {
  if (!selecting.expansion) {
    if (accent_button("Find what is like it", -1)) ui.issue("expand");
    return;
  }
  const auto found = static_cast<int>(selecting.expansion->size());
  if (found == 0) {
    hint("Nothing else is like it.");
    return;
  }
  int shown = static_cast<int>(selecting.shown);
  ImGui::SetNextItemWidth(-1);
  const std::string of = fmt::format("%d of {} {}", found, found == 1 ? "match" : "matches");
  if (ImGui::SliderInt("##shown", &shown, 0, found, of.c_str(), ImGuiSliderFlags_AlwaysClamp))
    ui.issue("matches {}", shown);
  if (accent_button("Select these")) {
    ui.issue("take");
    return;
  }
  ImGui::SameLine();
  if (ImGui::Button("None")) ui.issue("matches 0");
  ImGui::SameLine();
  if (ImGui::Button("Undo verdict")) ui.issue("reconsider");
  explain("Takes back the last Yes or No");
  const std::size_t listed = std::min<std::size_t>(static_cast<std::size_t>(shown) + 2, selecting.expansion->size());
  // A verdict changes the list: the rest of it is drawn in the next frame.
  const std::size_t steps = ui.session.log().size();
  const std::vector<sdk::Match> matches(selecting.expansion->first(listed).begin(),
                                        selecting.expansion->first(listed).end());
  for (std::size_t i = 0; i < matches.size() && ui.session.log().size() == steps; ++i)
    draw_match(ui, i + 1, matches[i], i < selecting.shown);
  const auto& rejected = selecting.expansion->rejected();
  if (rejected.empty() || !ImGui::TreeNode("rejected", "Left out: %zu", rejected.size())) return;
  for (std::size_t i = 0; i < std::min<std::size_t>(rejected.size(), 12); ++i) hint(rejected[i].reason.c_str());
  ImGui::TreePop();
}

}  // namespace

void draw_select_panel(Ui& ui) {
  const Session& session = ui.session;
  if (!session.models[session.active_model]->mesh)
    return hint("Faces of meshes are selected: this is a sphere-mesh. Extract a mesh of it first.");
  const Selecting& selecting = session.models[session.active_model]->selecting;
  section("Select");
  if (session.models[session.active_model]->posing)
    hint(
        "Regions are selected at rest, and the mesh is being posed: keep it as a model, or put it back, on the page "
        "Spheres.");
  else
    draw_tools(ui);
  if ((session.tool == Tool::Look || session.tool == Tool::Pose) && selecting.selection.faces().empty() &&
      selecting.reference.empty())
    return;
  ImGui::BeginDisabled(session.job.running());
  if (ImGui::Button("Undo")) ui.issue("undo");
  ImGui::SameLine();
  if (ImGui::Button("Redo")) ui.issue("redo");
  ImGui::SameLine();
  if (ImGui::Button("Clear")) ui.issue("clear");
  if (selecting.kind == Selecting::Kind::Part) {
    ImGui::SameLine();
    if (ImGui::Button("Other side")) ui.issue("other-side");
  }
  if (!selecting.reference.empty()) {
    if (ImGui::Button("Better boundary")) ui.issue("snap");
    explain("Lets it run where the surface is best cut nearby");
  }
  if (selecting.selection.faces().empty()) {
    ImGui::TextDisabled("nothing selected");
  } else {
    ImGui::TextDisabled("%zu faces selected, in %zu %s", selecting.selection.faces().size(), selecting.pieces,
                        selecting.pieces == 1 ? "piece" : "pieces");
  }
  if (!selecting.reference.empty()) draw_expansion(ui, selecting);
  ImGui::EndDisabled();
}

}  // namespace armature::viewer
