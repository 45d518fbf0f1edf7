// Below the view: what goes on, what went wrong, or what the mouse does.
#include <algorithm>
#include <array>

#include "viewer/app/theme.h"
#include "viewer/app/ui.h"

namespace armature::viewer {
namespace {

/// A line of text or buttons, and what is beside the text; units of layout.
constexpr float kLine = 36, kMargin = 14, kBeside = 18;

const char* what_the_mouse_does(const Session& session) {
  static constexpr std::array<const char*, 8> kHints = {
      "Drag to turn, right-drag to move, wheel to zoom.",
      "Click on a component. Alt moves the camera.",
      "Draw along the cut; Shift draws on at the same cut. Alt moves the camera.",
      "Brush over the patch; Shift adds to it, Ctrl takes away. The wheel changes the brush. Alt moves the camera.",
      "Draw a loop around what you want. Alt moves the camera.",
      "Drag the boundary of what is selected to where it should run. Alt moves the camera.",
      "Click what you want to move, then drag its handles. Alt moves the camera.",
      "Click a spot: colours show what is like it. Alt moves the camera."};
  return session.mode == Mode::Walk ? "W A S D or arrow keys walk, or drag in the view."
         : session.models.empty()   ? "Ctrl+O opens a file. Tab hides what is on the left."
                                    : kHints[static_cast<std::size_t>(session.tool)];
}

float height_of(const std::string& text, float width) {
  return ImGui::CalcTextSize(text.c_str(), nullptr, false, width).y;
}

/// The button first: no title and no bar pushes it out of the window.
void draw_job(Ui& ui, const Job& job, bool can_be_cancelled) {
  const JobProgress progress = job.progress();
  if (can_be_cancelled) {
    ImGui::BeginDisabled(job.stopping());
    if (ImGui::Button("Cancel")) ui.issue("cancel");
    ImGui::EndDisabled();
    ImGui::SameLine();
  }
  const float room = ImGui::GetContentRegionAvail().x, bar = std::min(ui.px(220), 0.4F * room);
  if (bar > ui.px(60)) {
    const bool fits = ImGui::CalcTextSize(progress.stage.c_str()).x < bar;
    ImGui::ProgressBar(static_cast<float>(progress.fraction), {bar, 0}, fits ? progress.stage.c_str() : "");
    ImGui::SameLine();
  }
  const std::string title = (job.stopping() ? "stopping: " : "") + job.title();
  ImGui::TextUnformatted(shortened(title, ImGui::GetContentRegionAvail().x).c_str());
}

}  // namespace

std::string end_of(const std::string& text, const std::function<bool(const std::string&)>& fits) {
  if (fits(text)) return text;
  const auto from = [&](std::size_t place) {
    while (place < text.size() && (text[place] & 0xC0) == 0x80) ++place;  // in a letter of several bytes
    return "..." + text.substr(place);
  };
  std::size_t too_much = 0, little = text.size();
  while (little - too_much > 1) {
    const std::size_t middle = too_much + (little - too_much) / 2;
    (fits(from(middle)) ? little : too_much) = middle;
  }
  return little == text.size() ? text : from(little);
}

float status_height(const Ui& ui, float width, bool says_what_the_mouse_does) {
  const Session& session = ui.session;
  const float room = width - 2 * ui.px(kMargin);
  // While something goes on nothing is told, but the view keeps its size.
  float lines = says_what_the_mouse_does ? height_of(what_the_mouse_does(session), room) : 0;
  if (!session.job.running()) lines = std::max(lines, height_of(session.notice, room));
  return std::max(ui.px(kLine), lines + ui.px(kBeside));
}

void draw_status_bar(Ui& ui, const Area& area) {
  const Session& session = ui.session;
  ImGui::SetNextWindowPos(area.at);
  ImGui::SetNextWindowSize(area.size);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {ui.px(kMargin), ui.px(5)});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1, 1});
  ImGui::PushStyleColor(ImGuiCol_WindowBg, IM_COL32(240, 241, 241, 255));
  ImGui::Begin("status", nullptr, kFixedWindow | ImGuiWindowFlags_NoScrollbar);
  ImGui::PopStyleColor();
  ImGui::PopStyleVar(3);
  ImGui::AlignTextToFramePadding();
  if (session.job.running()) {
    // A cut waits for what is being prepared for it.
    const bool waits = session.preparing.running() && session.job.progress().stage.empty() && !session.job.stopping();
    draw_job(ui, waits ? session.preparing : session.job, !session.job.whole());
  } else if (!session.notice.empty()) {
    const ImVec2 room = ImGui::GetContentRegionAvail();
    ImGui::PushStyleColor(ImGuiCol_Text, session.notice_is_error ? theme::kBad : theme::kInk);
    ImGui::TextWrapped("%s", end_of(session.notice, [&](const std::string& part) {
                               return height_of(part, room.x) <= room.y;
                             }).c_str());
    ImGui::PopStyleColor();
    explain(session.notice.c_str());
    if (ImGui::IsItemClicked()) ui.tell("");
  } else if (session.preparing.running()) {
    draw_job(ui, session.preparing, false);
  } else {
    hint(what_the_mouse_does(session));
  }
  ImGui::End();
}

}  // namespace armature::viewer
