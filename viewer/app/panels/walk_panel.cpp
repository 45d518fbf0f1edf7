// Who is listened to, and how motions become speeds.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "viewer/app/motion_figure.h"
#include "viewer/app/theme.h"
#include "viewer/app/ui.h"

namespace armature::viewer {
namespace {

using navproto::MotionId;

constexpr float kDegrees = static_cast<float>(180 / std::numbers::pi);

/// What the sliders show: what holds, but for what is being moved.
struct Edited {
  int motion = -1;
  float range_deg = 0, alpha = 0, beta = 0;
  float walk_m_s = 0, turn_deg_s = 0;
  bool active = false;
};

int draw_motion_choice(const char* label, MotionId motion) {
  int chosen = -1;
  if (ImGui::BeginCombo(label, motion_title(motion))) {
    for (int i = 0; i < static_cast<int>(navproto::kMotionCount); ++i)
      if (ImGui::Selectable(motion_title(static_cast<MotionId>(i)), i == static_cast<int>(motion))) chosen = i;
    ImGui::EndCombo();
  }
  return chosen;
}

/// A slider whose value is sent once it is let go.
bool slider(const char* label, float& value, float least, float most, const char* format, Edited& edited) {
  ImGui::SliderFloat(label, &value, least, most, format, ImGuiSliderFlags_AlwaysClamp);
  edited.active = edited.active || ImGui::IsItemActive();
  return ImGui::IsItemDeactivatedAfterEdit();
}

void draw_settings(Ui& ui, const navproto::ControlSettings& settings) {
  static Edited edited;
  const MotionId turn = settings.turn_motion.value_or(MotionId::LeanBust);
  const MotionId walk = settings.walk_motion.value_or(MotionId::BendKnees);
  section("Motions");
  ImGui::PushItemWidth(-ui.px(74));
  if (const int chosen = draw_motion_choice("turns", turn); chosen >= 0)
    ui.issue("pair {} {}", navproto::name(static_cast<MotionId>(chosen)), navproto::name(walk));
  if (const int chosen = draw_motion_choice("walks", walk); chosen >= 0)
    ui.issue("pair {} {}", navproto::name(turn), navproto::name(static_cast<MotionId>(chosen)));
  if (!edited.active) {
    edited.walk_m_s = settings.max_walk_m_s.value_or(0);
    edited.turn_deg_s = kDegrees * settings.max_turn_rad_s.value_or(0);
    if (edited.motion < 0) edited.motion = static_cast<int>(walk);
    for (const auto& motion : settings.motions) {
      if (static_cast<int>(motion.motion) != edited.motion) continue;
      edited.range_deg = kDegrees * motion.range_rad.value_or(0);
      edited.alpha = motion.alpha.value_or(0);
      edited.beta = motion.beta.value_or(0);
    }
  }
  edited.active = false;
  bool sent = slider("m/s", edited.walk_m_s, 0.1F, 5, "at most %.1f", edited);
  sent = slider("deg/s", edited.turn_deg_s, 5, 180, "at most %.0f", edited) || sent;
  if (sent) ui.issue("speeds {:.3g} {:.4g}", edited.walk_m_s, edited.turn_deg_s);
  ImGui::Spacing();
  if (const int chosen = draw_motion_choice("of", static_cast<MotionId>(edited.motion)); chosen >= 0)
    edited.motion = chosen;
  sent = slider("range", edited.range_deg, 1, 120, "%.0f degrees", edited);
  sent = slider("alpha", edited.alpha, 0, 0.9F, "dead zone %.2f", edited) || sent;
  sent = slider("beta", edited.beta, 0.2F, 5, "slope %.2f", edited) || sent;
  if (sent)
    ui.issue("motion {} {:.4g} {:.3g} {:.3g}", navproto::name(static_cast<MotionId>(edited.motion)), edited.range_deg,
             edited.alpha, edited.beta);
  ImGui::PopItemWidth();
  if (ImGui::Button("Save")) ui.issue("save-settings");
  explain("Writes what holds to the daemon's file");
  ImGui::SameLine();
  if (ImGui::Button("Reload")) ui.issue("reload-settings");
  ImGui::SameLine();
  if (ImGui::Button("New rest pose")) ui.issue("rerest");
}

/// Which daemon; over a network also who we are.
void draw_connection(Ui& ui) {
  static std::array<char, 256> endpoint{"ipc:///run/armature/nav"}, keys{}, server{};
  ImGui::SetNextItemWidth(-1);
  ImGui::InputText("##endpoint", endpoint.data(), endpoint.size());
  const bool network = std::string_view(endpoint.data()).starts_with("tcp:");
  if (network) {
    ImGui::SetNextItemWidth(-1);
    ImGui::InputTextWithHint("##keys", "our key file, if it asks for one", keys.data(), keys.size());
    ImGui::SetNextItemWidth(-1);
    ImGui::InputTextWithHint("##server", "its public key", server.data(), server.size());
  }
  if (!ImGui::Button("Connect to this daemon", {-1, 0})) return;
  std::string line = "connect " + as_word(endpoint.data());
  if (network && keys[0] != 0) line += fmt::format(" {} {}", as_word(keys.data()), as_word(server.data()));
  ui.issue("{}", line);
}

void draw_path(Ui& ui) {
  const auto& task = ui.session.walk.task();
  section("Follow a path");
  if (!task) {
    if (ImGui::Button("Begin", {-1, 0})) ui.issue("path start");
    return;
  }
  ImGui::ProgressBar(static_cast<float>(task->along_m() / task->length_m()), {-1, ui.px(6)}, "");
  ImGui::Text("%.0f s", task->time().count());
  ImGui::SameLine();
  ImGui::PushStyleColor(ImGuiCol_Text, task->close() ? theme::kGood : theme::kBad);
  ImGui::Text("%.1f m from it", task->distance_m());
  ImGui::PopStyleColor();
  ImGui::TextDisabled("%.2f m on average, %.2f %%", task->mean_deviation_m(), task->deviation_percent());
  explain("The mean of the squared distance, in percent of the path's length");
  if (task->finished()) ImGui::TextColored({0.2F, 0.55F, 0.3F, 1}, "Arrived.");
  if (ImGui::Button("Again")) ui.issue("path start");
  ImGui::SameLine();
  if (ImGui::Button("End")) ui.issue("path stop");
}

}  // namespace

void draw_walk_panel(Ui& ui) {
  const Walk& walk = ui.session.walk;
  section(walk.connected() ? "Your body" : "Who steers");
  ImGui::TextWrapped("%s", walk.state_in_words().c_str());
  if (!walk.connected()) {
    if (accent_button("Start a synthetic person", -1)) ui.issue("person");
    draw_connection(ui);
  } else {
    if (const auto& health = walk.health(); health && health->frames_per_second > 0)
      ImGui::TextDisabled("%.0f frames a second, %.1f ms", static_cast<double>(health->frames_per_second),
                          static_cast<double>(health->latency_p50_us) / 1000);
    ImGui::TextDisabled("%s", walk.endpoint().c_str());
    if (ImGui::Button("Disconnect")) ui.issue("disconnect");
  }
  draw_path(ui);
  if (const auto& settings = walk.settings()) draw_settings(ui, *settings);
  section("Camera");
  if (ImGui::Button("Back to the start")) ui.issue("place 0 0 0");
}

}  // namespace armature::viewer
