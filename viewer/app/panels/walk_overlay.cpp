// Over the city: the person as in a mirror, gauges of the motions, speeds; and what to do while the rest pose is taken.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "viewer/app/motion_figure.h"
#include "viewer/app/theme.h"
#include "viewer/app/ui.h"

namespace armature::viewer {
namespace {

using navproto::JointId;
using navproto::JointState;
using navproto::MotionId;

constexpr std::array<std::pair<JointId, JointId>, 19> kBones = {{
    {JointId::Head, JointId::Neck},
    {JointId::Neck, JointId::Torso},
    {JointId::Torso, JointId::Waist},
    {JointId::Neck, JointId::LeftShoulder},
    {JointId::LeftShoulder, JointId::LeftElbow},
    {JointId::LeftElbow, JointId::LeftWrist},
    {JointId::LeftWrist, JointId::LeftHand},
    {JointId::Waist, JointId::LeftHip},
    {JointId::LeftHip, JointId::LeftKnee},
    {JointId::LeftKnee, JointId::LeftAnkle},
    {JointId::LeftAnkle, JointId::LeftFoot},
    {JointId::Neck, JointId::RightShoulder},
    {JointId::RightShoulder, JointId::RightElbow},
    {JointId::RightElbow, JointId::RightWrist},
    {JointId::RightWrist, JointId::RightHand},
    {JointId::Waist, JointId::RightHip},
    {JointId::RightHip, JointId::RightKnee},
    {JointId::RightKnee, JointId::RightAnkle},
    {JointId::RightAnkle, JointId::RightFoot},
}};

void draw_card(ImDrawList& draw, const Area& area, float rounding) {
  draw.AddRectFilled(area.at, area.end(), theme::kVeil, rounding);
}

/// Depth, silhouette and skeleton, mirrored: a raised left hand is raised on the left.
void draw_mirror(Ui& ui, ImDrawList& draw, const Area& area) {
  const Walk& walk = ui.session.walk;
  draw_card(draw, area, ui.px(8));
  const float pad = ui.px(6);
  const Area inside{{area.at.x + pad, area.at.y + pad}, {area.size.x - 2 * pad, area.size.y - 2 * pad}};
  if (ui.depth != nullptr) {
    draw.AddImageRounded(ui.depth, inside.at, inside.end(), {1, 0}, {0, 1}, IM_COL32_WHITE, ui.px(5));
  } else {
    const char* text = "no depth yet";
    const ImVec2 size = ImGui::CalcTextSize(text);
    draw.AddText({inside.at.x + (inside.size.x - size.x) / 2, inside.at.y + (inside.size.y - size.y) / 2}, theme::kDim,
                 text);
  }
  const auto feed = walk.feed();
  const auto& skeleton = walk.skeleton();
  if (!feed || !skeleton || !skeleton->tracking || !walk.fresh()) return;
  const auto& camera = feed->intrinsics;
  const auto at = [&](JointId joint) -> ImVec2 {
    const auto& p = skeleton->joints[static_cast<std::size_t>(joint)].position;
    const double z = std::max(0.1, static_cast<double>(p.z));
    const double u = (camera.centre_x_px + camera.focal_x_px * static_cast<double>(p.x) / z + 0.5) / camera.width;
    const double v = (camera.centre_y_px + camera.focal_y_px * static_cast<double>(p.y) / z + 0.5) / camera.height;
    return {inside.at.x + inside.size.x * static_cast<float>(1 - u),
            inside.at.y + inside.size.y * static_cast<float>(v)};
  };
  draw.PushClipRect(inside.at, inside.end(), true);
  for (const auto& [from, to] : kBones) {
    const auto state = skeleton->joints[static_cast<std::size_t>(to)].state;
    if (state == JointState::Lost) continue;
    draw.AddLine(at(from), at(to),
                 state == JointState::Observed ? IM_COL32(255, 255, 255, 235) : IM_COL32(255, 255, 255, 110), ui.px(2));
  }
  draw.AddCircle(at(JointId::Head), ui.px(7), IM_COL32(255, 255, 255, 235), 20, ui.px(2));
  draw.PopClipRect();
}

/// A motion between its extremes: the dead zone hatched, the value as a bar from the middle.
void draw_gauge(Ui& ui, ImDrawList& draw, const Area& area, MotionId motion, float alpha, ImU32 colour, bool alive) {
  const auto& navigation = ui.session.walk.navigation();
  const auto& value = navigation ? navigation->motions[static_cast<std::size_t>(motion)] : navproto::MotionValue{};
  const float middle = area.at.x + area.size.x / 2, half = area.size.x / 2;
  const float top = area.at.y, bottom = area.end().y;
  draw.AddRectFilled({area.at.x, top}, {area.end().x, bottom}, IM_COL32(228, 230, 233, 255), ui.px(3));
  draw.AddRectFilled({middle - alpha * half, top}, {middle + alpha * half, bottom}, IM_COL32(208, 212, 217, 255));
  if (alive && std::isfinite(value.normalised)) {
    const float end = middle + half * std::clamp(value.normalised, -1.F, 1.F);
    draw.AddRectFilled({std::min(middle, end), top}, {std::max(middle, end), bottom}, colour, ui.px(3));
  }
  draw.AddLine({middle, top - 1}, {middle, bottom + 1}, theme::kDim, 1);
}

void draw_gauges(Ui& ui, ImDrawList& draw, const Area& area) {
  const Walk& walk = ui.session.walk;
  const auto& navigation = walk.navigation();
  const bool alive = navigation.has_value() && walk.fresh();
  draw_card(draw, area, ui.px(8));
  const float pad = ui.px(10);
  const float name = ui.px(112);
  const float row = (area.size.y - 2 * pad) / 7;
  // The seven of the thesis; rotate_bust is what two of them have in common.
  int place = 0;
  for (std::size_t i = 0; i < navproto::kMotionCount; ++i) {
    const auto motion = static_cast<MotionId>(i);
    if (motion == MotionId::RotateBust) continue;
    const bool steers = navigation && (navigation->walk_motion == motion || navigation->turn_motion == motion);
    float alpha = 0;
    if (const auto& settings = walk.settings())
      for (const auto& setting : settings->motions)
        if (setting.motion == motion) alpha = setting.alpha.value_or(0);
    const float y = area.at.y + pad + row * static_cast<float>(place++);
    draw.AddText({area.at.x + pad, y + (row - ImGui::GetTextLineHeight()) / 2}, steers ? theme::kInk : theme::kDim,
                 motion_title(motion));
    const float height = std::min(ui.px(9), 0.6F * row);
    draw_gauge(ui, draw, {{area.at.x + pad + name, y + (row - height) / 2}, {area.size.x - 2 * pad - name, height}},
               motion, alpha, steers ? theme::kAccent : IM_COL32(150, 162, 178, 255), alive);
  }
}

void draw_speeds(Ui& ui, ImDrawList& draw, const Area& area) {
  const Walk& walk = ui.session.walk;
  draw_card(draw, area, ui.px(8));
  const navproto::Velocity& v = walk.velocity();
  const std::array<std::pair<std::string, const char*>, 2> values = {
      {{fmt::format("{:.1f} m/s", v.linear_m_s), v.linear_m_s < -0.005  ? "backward"
                                                 : v.linear_m_s > 0.005 ? "forward"
                                                                        : "standing"},
       {fmt::format("{:.0f}°/s", std::abs(v.angular_rad_s) * 57.2958), v.angular_rad_s > 0.005    ? "to the left"
                                                                       : v.angular_rad_s < -0.005 ? "to the right"
                                                                                                  : "straight on"}}};
  for (std::size_t i = 0; i < 2; ++i) {
    const ImVec2 at(area.at.x + ui.px(14) + static_cast<float>(i) * area.size.x / 2, area.at.y + ui.px(9));
    draw.AddText(theme::large(), theme::large()->FontSize, at, theme::kInk, values[i].first.c_str());
    draw.AddText({at.x, at.y + theme::large()->FontSize + ui.px(2)}, theme::kDim, values[i].second);
  }
}

/// Figure 3.9: the two motions, while the person stands still.
void draw_initialisation(Ui& ui, ImDrawList& draw) {
  const auto& navigation = ui.session.walk.navigation();
  if (!navigation || !ui.session.walk.fresh()) return;
  const bool capturing = navigation->engagement == navproto::Engagement::CapturingRest;
  if (!capturing && navigation->engagement != navproto::Engagement::Detected) return;
  const Area& view = ui.view;
  const float width = std::min(ui.px(560), 0.94F * view.size.x), height = std::min(ui.px(310), 0.94F * view.size.y);
  const Area card{{view.at.x + (view.size.x - width) / 2, view.at.y + 0.45F * (view.size.y - height)}, {width, height}};
  draw_card(draw, card, ui.px(14));
  const auto centred = [&](ImFont* font, float x, float y, ImU32 colour, const char* text) {
    const ImVec2 size = font->CalcTextSizeA(font->FontSize, 1e9F, 0, text);
    draw.AddText(font, font->FontSize, {x - size.x / 2, y}, colour, text);
  };
  const float middle = card.at.x + width / 2;
  centred(theme::large(), middle, card.at.y + ui.px(18), theme::kInk,
          capturing ? "Stand still for a moment" : "Stand in front of the sensor");
  const double seconds = std::chrono::duration<double>(ui.session.now).count();
  const auto phase = static_cast<float>(std::sin(2.2 * seconds));
  struct Role {
    MotionId motion;
    const char* what;
    float x;
  };
  for (const Role& role :
       {Role{navigation->turn_motion, "to turn", -0.25F}, Role{navigation->walk_motion, "to walk", 0.25F}}) {
    const float x = middle + role.x * width;
    draw_motion_figure(draw, {x, card.at.y + 0.5F * height}, 0.42F * height, role.motion, phase, theme::kInk,
                       theme::kAccent);
    centred(theme::heading(), x, card.end().y - ui.px(58), theme::kInk, motion_advice(role.motion));
    centred(ImGui::GetFont(), x, card.end().y - ui.px(36), theme::kDim, role.what);
  }
}

}  // namespace

void draw_walk_overlay(Ui& ui) {
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  const Area& view = ui.view;
  const Walk& walk = ui.session.walk;
  draw.PushClipRect(view.at, view.end());
  draw_initialisation(ui, draw);
  const float gap = ui.px(14);
  // In a small window the city matters most.
  if (walk.connected() && view.size.x > ui.px(520) && view.size.y > ui.px(360)) {
    const float width = std::min(ui.px(250), 0.28F * view.size.x);
    draw_mirror(ui, draw, {{view.end().x - width - gap, view.at.y + gap}, {width, width / ui.depth_aspect}});
    draw_gauges(ui, draw,
                {{view.end().x - ui.px(330) - gap, view.end().y - ui.px(176) - gap}, {ui.px(330), ui.px(176)}});
    draw_speeds(ui, draw, {{view.at.x + gap, view.end().y - ui.px(70) - gap}, {ui.px(230), ui.px(70)}});
  }
  draw.PopClipRect();
}

}  // namespace armature::viewer
