// What is like a spot or a selection, and edits of all that is.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <span>
#include <string>

#include "viewer/app/theme.h"
#include "viewer/app/ui.h"

namespace armature::viewer {
namespace {

/// An edit as the panel shows it: what it is called, how far its slider goes, what is written on it.
struct Choice {
  EditOp op;
  const char* name;
  float least, most;
  const char* format;
};
constexpr std::array<Choice, 4> kByMap = {{{EditOp::Displace, "Push out or in", -5, 5, "%.1f %% of its size"},
                                           {EditOp::Smooth, "Smooth", 0, 5, "over %.1f %% of its size"},
                                           {EditOp::Sharpen, "Sharpen", 0, 4, "%.1f times"},
                                           {EditOp::Paint, "Paint", 0, 100, "%.0f %%"}}};
constexpr std::array<Choice, 6> kByRegions = {{{EditOp::Displace, "Push out or in", -5, 5, "%.1f %% of its size"},
                                               {EditOp::Smooth, "Smooth", 0, 5, "over %.1f %% of its size"},
                                               {EditOp::Pull, "Pull the middle", -10, 10, "%.1f %% of its size"},
                                               {EditOp::Paint, "Paint", 0, 100, "%.0f %%"},
                                               {EditOp::Copy, "Give all the same shape", 0, 1, ""},
                                               {EditOp::Alike, "More alike, or less", -1, 1, "%.2f"}}};

/// What the sliders are at, and what they showed last: an edit follows its slider as fast as it is computed.
struct Wanted {
  int where = 0, op = 0;
  float amount = 0;
  bool waits = false;
  std::weak_ptr<const ShadedMesh> seen = {};  // the last one that was tried; or none
  float from = 0.1F, to = 0.9F;
};

std::span<const Choice> choices_of(int where) {
  return where == 1 ? std::span<const Choice>(kByRegions) : kByMap;
}

bool is_percent(EditOp op) {
  return op != EditOp::Sharpen && op != EditOp::Alike;
}

/// The panel shows the edit that is tried, a script's too; none, once it was kept, dropped or taken back.
void follow(const Session& session, Wanted& wanted) {
  const auto& tried = session.models[session.active_model]->editing.tried;
  const bool same = !wanted.seen.owner_before(tried) && !tried.owner_before(wanted.seen);
  if (wanted.waits || session.job.running() || same) return;
  wanted.seen = tried;
  wanted.amount = 0;
  if (!tried) return;
  wanted.where = tried->by.regions ? 1 : 0;
  const auto choices = choices_of(wanted.where);
  const auto chosen = std::ranges::find(choices, tried->by.op, &Choice::op);
  if (chosen == choices.end()) return;
  wanted.op = static_cast<int>(chosen - choices.begin());
  wanted.amount = static_cast<float>(tried->by.amount) * (is_percent(chosen->op) ? 100 : 1);
}

void draw_alike(Ui& ui, const Model& model) {
  const Session& session = ui.session;
  section("What is alike");
  const int by = choice_row("by", static_cast<int>(ui.like_by), {"GLS", "HKS", "WKS", "PSC"});
  if (by >= 0) ui.like_by = static_cast<Likeness>(by);
  static constexpr std::array<const char*, 4> kWhat = {
      "By curvature at many scales.", "By how heat spreads from there; bending changes little.",
      "By how waves dwell there; finer than heat.", "By the relief around it, up to a twentieth of the shape's size."};
  hint(kWhat[static_cast<std::size_t>(ui.like_by)]);
  const bool spot = session.tool == Tool::Spot;
  if (spot ? accent_button("Click a spot") : ImGui::Button("Click a spot")) ui.issue("tool {}", spot ? "look" : "spot");
  ImGui::SameLine();
  ImGui::BeginDisabled(session.job.running() || model.selecting.reference.empty());
  if (ImGui::Button("Like the selection")) ui.issue("similarity {}", kLikenesses[static_cast<std::size_t>(ui.like_by)]);
  ImGui::EndDisabled();
  if (!model.editing.similarity.empty()) {
    bool shown = session.looks.map == MapKind::Compared;
    if (ImGui::Checkbox("Show the map", &shown)) ui.issue("map {}", shown ? "compared" : "none");
  }
}

/// Where by a map: from how much similarity on.
void draw_transfer(Ui& ui, const Model& model, Wanted& wanted) {
  if (!wanted.waits && !ImGui::IsAnyItemActive()) {
    wanted.from = static_cast<float>(model.editing.transfer.from);
    wanted.to = static_cast<float>(model.editing.transfer.to);
  }
  ImGui::SetNextItemWidth(-1);
  const bool changed = ImGui::DragFloatRange2("##transfer", &wanted.from, &wanted.to, 0.005F, 0, 1, "from %.2f",
                                              "full at %.2f", ImGuiSliderFlags_AlwaysClamp);
  explain("How alike a place must be to be edited, and to be edited in full");
  if (!changed || !(wanted.to > wanted.from)) return;
  ui.issue("transfer {:.3g} {:.3g}", wanted.from, wanted.to);
  wanted.waits = model.editing.tried != nullptr;
}

void draw_edit(Ui& ui, const Model& model) {
  static Wanted wanted;
  const Session& session = ui.session;
  section("Edit");
  if (!ImGui::IsAnyItemActive()) follow(session, wanted);
  if (const int where = choice_row("where", wanted.where, {"By the map", "Regions"}); where >= 0) {
    wanted.where = where;
    wanted.op = 0;
    wanted.amount = 0;
  }
  const bool regions = wanted.where == 1;
  if (regions ? model.selecting.reference.empty() : model.editing.similarity.empty()) {
    hint(regions ? "Select a region first, and find what is like it: all of these are edited in the same way."
                 : "Click a spot first: what is like it is edited, the more alike the more.");
    return;
  }
  const std::span<const Choice> choices = choices_of(wanted.where);
  const Choice& chosen = choices[static_cast<std::size_t>(wanted.op)];
  ImGui::SetNextItemWidth(-1);
  if (ImGui::BeginCombo("##op", chosen.name)) {
    for (int i = 0; i < static_cast<int>(choices.size()); ++i) {
      if (!ImGui::Selectable(choices[static_cast<std::size_t>(i)].name, i == wanted.op)) continue;
      wanted.op = i;
      wanted.amount = 0;
    }
    ImGui::EndCombo();
  }
  if (chosen.op == EditOp::Copy) {
    if (ImGui::Button("Try it", {-1, 0})) wanted.waits = true;
  } else {
    ImGui::SetNextItemWidth(-1);
    if (ImGui::SliderFloat("##amount", &wanted.amount, chosen.least, chosen.most, chosen.format,
                           ImGuiSliderFlags_AlwaysClamp))
      wanted.waits = true;
  }
  if (!regions) draw_transfer(ui, model, wanted);
  if (wanted.waits && !session.job.running()) {
    wanted.waits = false;
    ui.issue("edit {} {:.4g} {}", kEditOps[static_cast<std::size_t>(chosen.op)],
             is_percent(chosen.op) ? wanted.amount / 100 : wanted.amount, regions ? "regions" : "map");
  }
}

}  // namespace

void draw_edit_panel(Ui& ui) {
  const Session& session = ui.session;
  const Model& model = *session.models[session.active_model];
  if (!model.mesh) return hint("Meshes can be edited: this is a sphere-mesh. Extract a mesh of it first.");
  if (model.posing) return hint("The mesh is being posed: keep it as a model, or put it back, on the page Spheres.");
  draw_alike(ui, model);
  draw_edit(ui, model);
  ImGui::BeginDisabled(session.job.running() || !model.editing.tried);
  if (accent_button("Keep")) ui.issue("keep-edit");
  ImGui::SameLine();
  if (ImGui::Button("Drop")) ui.issue("drop-edit");
  ImGui::EndDisabled();
  ImGui::SameLine();
  ImGui::BeginDisabled(session.job.running() || model.editing.before.empty());
  if (ImGui::Button("Undo a kept edit")) ui.issue("undo-edit");
  ImGui::EndDisabled();
}

}  // namespace armature::viewer
