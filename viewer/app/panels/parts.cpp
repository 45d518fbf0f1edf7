// Small things that panels are made of.
#include <cmath>

#include "viewer/app/theme.h"
#include "viewer/app/ui.h"

namespace armature::viewer {

void section(const char* title) {
  ImGui::Dummy({0, 0.25F * ImGui::GetTextLineHeight()});
  ImGui::PushFont(theme::heading());
  ImGui::TextUnformatted(title);
  ImGui::PopFont();
}

int choice_row(const char* id, int chosen, const std::vector<const char*>& names) {
  int clicked = -1;
  ImGui::PushID(id);
  const float gap = 2;
  const float width = (ImGui::GetContentRegionAvail().x - gap * static_cast<float>(names.size() - 1)) /
                      static_cast<float>(names.size());
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {gap, ImGui::GetStyle().ItemSpacing.y});
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {2, ImGui::GetStyle().FramePadding.y});
  for (int i = 0; i < static_cast<int>(names.size()); ++i) {
    if (i > 0) ImGui::SameLine();
    const bool is_chosen = i == chosen;
    if (is_chosen) {
      ImGui::PushStyleColor(ImGuiCol_Button, theme::kAccent);
      ImGui::PushStyleColor(ImGuiCol_ButtonHovered, theme::kAccent);
      ImGui::PushStyleColor(ImGuiCol_Text, IM_COL32_WHITE);
    }
    if (ImGui::Button(names[static_cast<std::size_t>(i)], {width, 0})) clicked = i;
    if (is_chosen) ImGui::PopStyleColor(3);
  }
  ImGui::PopStyleVar(2);
  ImGui::PopID();
  return clicked == chosen ? -1 : clicked;
}

bool accent_button(const char* label, float width) {
  ImGui::PushStyleColor(ImGuiCol_Button, theme::kAccent);
  ImGui::PushStyleColor(ImGuiCol_ButtonHovered, IM_COL32(56, 122, 204, 255));
  ImGui::PushStyleColor(ImGuiCol_Text, IM_COL32_WHITE);
  const bool clicked = ImGui::Button(label, {width, 0});
  ImGui::PopStyleColor(3);
  return clicked;
}

ImVec2 small_padding() {
  const float line = ImGui::GetTextLineHeight();
  return {std::round(0.6F * line), std::round(0.13F * line)};
}

bool small_button(const char* label) {
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, small_padding());
  const bool clicked = ImGui::Button(label);
  ImGui::PopStyleVar();
  return clicked;
}

std::string shortened(const std::string& text, float room) {
  const auto wide = [](const std::string& part) { return ImGui::CalcTextSize(part.c_str()).x; };
  if (wide(text) <= room) return text;
  const auto is_inside = [&](std::size_t at) { return at < text.size() && (text[at] & 0xC0) == 0x80; };
  std::size_t length = text.size();
  do {
    while (is_inside(--length)) {  // of a letter of several bytes
    }
  } while (length > 0 && wide(text.substr(0, length) + "...") > room);
  return text.substr(0, length) + "...";
}

void explain(const char* text) {
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", text);
}

void hint(const char* text) {
  ImGui::PushStyleColor(ImGuiCol_Text, theme::kDim);
  ImGui::TextWrapped("%s", text);
  ImGui::PopStyleColor();
}

}  // namespace armature::viewer
