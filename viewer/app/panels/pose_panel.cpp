// Deforming a mesh by its spheres.
#include "viewer/app/theme.h"
#include "viewer/app/ui.h"
#include "viewer/session/posing.h"

namespace armature::viewer {

void draw_pose_panel(Ui& ui) {
  const Session& session = ui.session;
  const Model& model = *session.models[session.active_model];
  section("Pose");
  ImGui::BeginDisabled(session.job.running());
  if (!model.posing) {
    if (ImGui::Button("Deform by these spheres", {-1, 0})) ui.issue("pose");
    ImGui::EndDisabled();
    return;
  }
  if (session.tool != Tool::Pose) {
    if (ImGui::Button("Go on posing", {-1, 0})) ui.issue("tool pose");
  } else if (model.handle.empty()) {
    hint("Click a sphere, an edge or a triangle; Shift adds to what is held.");
  } else {
    hint("Arrows and the white disc move, the ring turns, the square scales, the diamond swells.");
  }
  ImGui::TextDisabled("%zu held", model.handle.size());
  if (!model.handle.empty() && !session.job.running()) {  // work may be changing the level
    ImGui::SameLine();
    const bool pinned = model.pose->pinned[model.handle.front().index()];
    if (small_button(pinned ? "Unpin" : "Pin")) ui.issue("{}", pinned ? "unpin" : "pin");
  }
  if (ImGui::Button("Undo##pose")) ui.issue("undo");
  ImGui::SameLine();
  if (ImGui::Button("Redo##pose")) ui.issue("redo");
  ImGui::SameLine();
  if (ImGui::Button("Let go")) ui.issue("handle");
  if (accent_button("Keep as a model")) ui.issue("bake");
  ImGui::SameLine();
  if (ImGui::Button("Put back")) ui.issue("unpose");
  if (ImGui::Button("Save the steps...")) ask_for_file(ui, FileUse::SavePose);
  ImGui::SameLine();
  if (ImGui::Button("Replay...")) ask_for_file(ui, FileUse::ReplayPose);
  ImGui::EndDisabled();
}

}  // namespace armature::viewer
