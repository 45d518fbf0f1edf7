// Over the city: the person as in a mirror, gauges of the motions, speeds; and what to do while the rest pose is taken.
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

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
  draw.AddCircle(at(JointId::Head), 0.03F * inside.size.x, IM_COL32(255, 255, 255, 235), 20, ui.px(2));
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

/// A text in lines that are no wider than `room`, words whole where they fit.
std::vector<std::string_view> wrapped(const ImFont& font, std::string_view text, float room) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const char* const stop = font.CalcWordWrapPositionA(1, text.data(), text.data() + text.size(), room);
    const auto length = std::max<std::size_t>(1, static_cast<std::size_t>(stop - text.data()));
    lines.push_back(text.substr(0, length));
    text.remove_prefix(length);
    text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  }
  return lines;
}

/// Lines about a middle, from a height on; where they end.
float draw_centred(ImDrawList& draw, ImFont* font, float x, float y, ImU32 colour,
                   const std::vector<std::string_view>& lines) {
  for (const std::string_view line : lines) {
    const char *const begin = line.data(), *const end = begin + line.size();
    const float width = font->CalcTextSizeA(font->FontSize, 1e9F, 0, begin, end).x;
    draw.AddText(font, font->FontSize, {x - width / 2, y}, colour, begin, end);
    y += font->FontSize;
  }
  return y;
}

float height_of(const ImFont& font, const std::vector<std::string_view>& lines) {
  return font.FontSize * static_cast<float>(lines.size());
}

/// Figure 3.9: the two motions, while the person stands still. In a small view what is said comes first. Where it lies,
/// in what there is room for; of no size where nothing is to be said.
Area draw_initialisation(Ui& ui, ImDrawList& draw, const WalkCards& cards) {
  const auto& navigation = ui.session.walk.navigation();
  if (!navigation || !ui.session.walk.fresh()) return {};
  const bool capturing = navigation->engagement == navproto::Engagement::CapturingRest;
  if (!capturing && navigation->engagement != navproto::Engagement::Detected) return {};
  const Area& view = ui.view;
  const float width = std::min(ui.px(560), 0.94F * view.size.x), height = std::min(ui.px(310), 0.94F * view.size.y);
  // Below the mirror, if it can be.
  const float top = std::max(0.45F * (view.size.y - height),
                             std::min(cards.mirror.end().y - view.at.y + ui.px(8), 0.97F * view.size.y - height));
  const Area card{{view.at.x + (view.size.x - width) / 2, view.at.y + top}, {width, height}};
  draw_card(draw, card, ui.px(14));
  const float pad = std::min(ui.px(18), 0.06F * height), gap = std::min(ui.px(8), pad);
  const float middle = card.at.x + width / 2;
  const char* const title = capturing ? "Stand still for a moment" : "Stand in front of the sensor";
  ImFont* const plain = ImGui::GetFont();
  const bool wide = theme::large()->CalcTextSizeA(theme::large()->FontSize, 1e9F, 0, title).x < width - 2 * pad;
  ImFont* const font = wide && height > ui.px(200) ? theme::large() : theme::heading();
  const auto said = wrapped(*font, title, width - pad);
  struct Role {
    MotionId motion;
    const char* what;
    float x;
    std::vector<std::string_view> advice;
  };
  std::array<Role, 2> roles = {Role{navigation->turn_motion, "to turn", middle - 0.25F * width, {}},
                               Role{navigation->walk_motion, "to walk", middle + 0.25F * width, {}}};
  float advised = 0;
  for (Role& role : roles) {
    role.advice = wrapped(*theme::heading(), motion_advice(role.motion), 0.46F * width);
    advised = std::max(advised, height_of(*theme::heading(), role.advice));
  }
  const float told = height_of(*font, said), below = advised + gap / 2 + plain->FontSize + pad;
  const float free = height - pad - told - 2 * gap - below;
  if (free < -gap) {  // no room but for that
    draw_centred(draw, font, middle, card.at.y + std::max(0.F, (height - told) / 2), theme::kInk, said);
    return card;
  }
  const float from = draw_centred(draw, font, middle, card.at.y + pad, theme::kInk, said) + gap;
  const double seconds = std::chrono::duration<double>(ui.session.now).count();
  const auto phase = static_cast<float>(std::sin(2.2 * seconds));
  for (const Role& role : roles) {
    const float size = std::min(0.42F * height, free);
    if (size > ui.px(20))
      draw_motion_figure(draw, {role.x, from + free / 2}, size, role.motion, phase, theme::kInk, theme::kAccent);
    const float end =
        draw_centred(draw, theme::heading(), role.x, card.end().y - below, theme::kInk, role.advice) + gap / 2;
    draw_centred(draw, plain, role.x, end, theme::kDim, {role.what});
  }
  return card;
}

bool overlap(const Area& a, const Area& b) {
  return a.at.x < b.end().x && b.at.x < a.end().x && a.at.y < b.end().y && b.at.y < a.end().y;
}

}  // namespace

WalkCards place_walk_cards(const Ui& ui) {
  const Walk& walk = ui.session.walk;
  const float gap = std::min(ui.px(14), 0.04F * ui.view.size.x);
  Area room{{ui.view.at.x + gap, ui.view.at.y + gap}, {ui.view.size.x - 2 * gap, ui.view.size.y - 2 * gap}};
  WalkCards cards;
  if (ui.view.at.x == 0) {  // the sidebar, which tells it, is away
    const float wide = room.size.x - 2 * gap;
    const auto size_of = [&](const std::string& text) {
      return ImGui::CalcTextSize(text.c_str(), nullptr, false, wide);
    };
    cards.said = walk.state_in_words();
    if (size_of(cards.said).y > 0.5F * room.size.y) cards.said = shortened(cards.said, wide);  // the city is seen, too
    const ImVec2 size = size_of(cards.said);
    const float high = size.y + gap;
    cards.state = {{room.at.x, room.end().y - high}, {std::min(size.x + 2 * gap, room.size.x), high}};
    room.size.y -= high + gap;
  }
  if (!walk.connected() || room.size.x < ui.px(290) || room.size.y < ui.px(100)) return cards;
  const float high = ui.px(70);
  const float width = std::min({ui.px(250), std::max(ui.px(100), 0.28F * room.size.x), ui.depth_aspect * room.size.y});
  cards.mirror = {{room.end().x - width, room.at.y}, {width, width / ui.depth_aspect}};
  const float below = room.size.y - cards.mirror.size.y - gap, left = room.size.x - width - gap;
  cards.speeds = {{room.at.x, room.end().y - high}, {std::min(ui.px(230), below < high ? left : room.size.x), high}};
  // The gauges are beside the speeds, or the speeds beside the mirror. In a small view the city matters most.
  const float right = room.size.x - cards.speeds.size.x - gap;
  const bool both = right >= ui.px(230);
  const ImVec2 gauges(std::min(ui.px(330), both ? right : room.size.x),
                      std::min(ui.px(176), std::max(ui.px(130), 0.38F * room.size.y)));
  if (gauges.y > below || room.size.y < ui.px(300) || (!both && left < ui.px(180))) return cards;
  cards.gauges = {{room.end().x - gauges.x, room.end().y - gauges.y}, gauges};
  if (!both) cards.speeds = {room.at, {std::min(ui.px(230), left), high}};
  return cards;
}

void draw_walk_overlay(Ui& ui) {
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  const WalkCards cards = place_walk_cards(ui);
  draw.PushClipRect(ui.view.at, ui.view.end());
  const Area over = draw_initialisation(ui, draw, cards);
  const auto is_seen = [&](const Area& card) { return card.size.x > 0 && !overlap(card, over); };
  if (is_seen(cards.mirror)) draw_mirror(ui, draw, cards.mirror);
  if (is_seen(cards.gauges)) draw_gauges(ui, draw, cards.gauges);
  if (is_seen(cards.speeds)) draw_speeds(ui, draw, cards.speeds);
  if (is_seen(cards.state)) {
    draw_card(draw, cards.state, ui.px(8));
    const float pad = std::min(ui.px(14), 0.04F * ui.view.size.x);
    draw.AddText(ImGui::GetFont(), ImGui::GetFontSize(), {cards.state.at.x + pad, cards.state.at.y + pad / 2},
                 theme::kInk, cards.said.c_str(), nullptr, cards.state.size.x - 2 * pad + 1);
  }
  draw.PopClipRect();
}

}  // namespace armature::viewer
