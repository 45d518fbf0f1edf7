#include "viewer/app/motion_figure.h"

#include <array>
#include <cmath>

namespace armature::viewer {
namespace {

using navproto::MotionId;

struct Pen {
  ImDrawList& draw;
  ImVec2 centre;
  float size;  // pixels a unit; the figure is about two units high, its middle at 0

  [[nodiscard]] ImVec2 at(float x, float y) const { return {centre.x + size * x, centre.y - size * y}; }
  void line(const ImVec2& a, const ImVec2& b, ImU32 colour, float width = 0.075F) const {
    draw.AddLine(a, b, colour, width * size);
    draw.AddCircleFilled(a, 0.5F * width * size, colour);
    draw.AddCircleFilled(b, 0.5F * width * size, colour);
  }
  void head(const ImVec2& at, ImU32 colour) const { draw.AddCircleFilled(at, 0.15F * size, colour); }
};

/// Shoulders or hips as a bar that turns, the feet below it.
void draw_from_above(const Pen& pen, float turn_rad, bool hips, ImU32 colour, ImU32 accent) {
  const float c = std::cos(turn_rad), s = std::sin(turn_rad);
  const auto turned = [&](float x, float y) { return pen.at(c * x - s * y, s * x + c * y); };
  for (const float side : {-1.F, 1.F})
    pen.draw.AddLine(pen.at(0.18F * side, 0.1F), pen.at(0.22F * side, 0.42F), colour, 0.12F * pen.size);
  if (hips) pen.line(pen.at(-0.55F, 0), pen.at(0.55F, 0), colour, 0.1F);
  const float half = hips ? 0.38F : 0.6F;
  pen.line(turned(-half, 0), turned(half, 0), accent, 0.2F);
  pen.head(hips ? pen.at(0, 0) : turned(0, 0.04F), colour);
  // An arc with an arrow, the way it turns.
  constexpr float kRadius = 0.85F;
  const float end = turn_rad >= 0 ? 0.9F : -0.9F;
  constexpr float kUp = 1.5708F;
  std::array<ImVec2, 13> arc;
  for (std::size_t i = 0; i < arc.size(); ++i) {
    const float angle = kUp + end * (static_cast<float>(i) / 12 - 0.5F);
    arc[i] = pen.at(kRadius * std::cos(angle), kRadius * std::sin(angle));
  }
  pen.draw.AddPolyline(arc.data(), static_cast<int>(arc.size()), accent, 0, 0.05F * pen.size);
  pen.draw.AddCircleFilled(arc.back(), 0.07F * pen.size, accent);
}

void draw_from_front(const Pen& pen, float lean, float shift, ImU32 colour, ImU32 accent) {
  const float hip = shift;
  const ImVec2 hips = pen.at(hip, -0.1F);
  const ImVec2 neck = pen.at(hip + 0.62F * std::sin(lean) - 0.5F * shift, -0.1F + 0.62F * std::cos(lean));
  for (const float side : {-1.F, 1.F}) {
    pen.line(pen.at(hip + 0.14F * side, -0.1F), pen.at(0.18F * side, -0.95F), colour);
    const ImVec2 shoulder(neck.x + side * 0.26F * pen.size * std::cos(lean),
                          neck.y + side * 0.26F * pen.size * std::sin(lean));
    pen.line(shoulder, {shoulder.x + side * 0.08F * pen.size, shoulder.y + 0.52F * pen.size}, colour);
    pen.line(neck, shoulder, colour);
  }
  pen.line(pen.at(hip - 0.14F, -0.1F), pen.at(hip + 0.14F, -0.1F), shift != 0 ? accent : colour, 0.12F);
  pen.line(hips, neck, lean != 0 ? accent : colour, 0.12F);
  pen.head({neck.x + 0.27F * pen.size * std::sin(lean), neck.y - 0.27F * pen.size * std::cos(lean)}, colour);
}

void draw_from_side(const Pen& pen, float bend, float knees, float step, ImU32 colour, ImU32 accent) {
  // Facing right; bent knees let the hips sink.
  const float sink = 0.24F * std::max(knees, 0.F);
  const float rise = knees < 0 ? 0.08F * -knees : 0;
  const ImVec2 hips = pen.at(0.5F * step, -0.1F - sink + rise);
  const ImVec2 neck = pen.at(0.5F * step + 0.62F * std::sin(bend), -0.1F - sink + rise + 0.62F * std::cos(bend));
  for (const bool front : {false, true}) {
    const float foot_x = front ? step : 0;
    const ImVec2 foot = pen.at(foot_x, -0.95F + (knees < 0 ? 0.06F : 0));
    const ImVec2 knee =
        pen.at(0.5F * (0.5F * step + foot_x) + 0.28F * std::max(knees, 0.F) + 0.04F, -0.52F - 0.4F * sink + rise);
    const ImU32 leg = knees != 0 || (step != 0 && front) ? accent : colour;
    pen.line(hips, knee, leg);
    pen.line(knee, foot, leg);
    pen.line(foot, {foot.x + 0.16F * pen.size, foot.y}, leg);
  }
  pen.line(hips, neck, bend != 0 ? accent : colour, 0.12F);
  pen.line(neck, {neck.x + 0.06F * pen.size, neck.y + 0.5F * pen.size}, colour);
  pen.head({neck.x + 0.27F * pen.size * std::sin(bend), neck.y - 0.27F * pen.size * std::cos(bend)}, colour);
}

}  // namespace

void draw_motion_figure(ImDrawList& draw, const ImVec2& centre, float size, MotionId motion, float phase, ImU32 colour,
                        ImU32 accent) {
  const Pen pen{draw, centre, size / 2.4F};
  // What does not move now is still marked.
  const float moved = std::abs(phase) < 1e-3F ? 1e-3F : phase;
  switch (motion) {
    case MotionId::RotateShoulders:
    case MotionId::RotateBust: draw_from_above(pen, 0.6F * moved, false, colour, accent); break;
    case MotionId::RotateHips: draw_from_above(pen, 0.5F * moved, true, colour, accent); break;
    case MotionId::LeanBust: draw_from_front(pen, 0.4F * moved, 0, colour, accent); break;
    case MotionId::TranslateHips: draw_from_front(pen, 0, 0.22F * moved, colour, accent); break;
    case MotionId::BendBust: draw_from_side(pen, 0.5F * moved, 0, 0, colour, accent); break;
    case MotionId::BendKnees: draw_from_side(pen, 0, moved, 0, colour, accent); break;
    case MotionId::Step: draw_from_side(pen, 0, 0, 0.42F * moved, colour, accent); break;
  }
}

const char* motion_title(MotionId motion) {
  static constexpr std::array<const char*, navproto::kMotionCount> kTitles = {
      "Rotate shoulders", "Rotate hips",    "Rotate bust", "Lean bust",
      "Bend bust",        "Translate hips", "Bend knees",  "Step"};
  return kTitles[static_cast<std::size_t>(motion)];
}

const char* motion_advice(MotionId motion) {
  static constexpr std::array<const char*, navproto::kMotionCount> kAdvice = {"Turn your shoulders to a side",
                                                                              "Turn your hips to a side",
                                                                              "Turn your bust to a side",
                                                                              "Lean your bust to a side",
                                                                              "Bend forward or backward",
                                                                              "Move your hips to a side",
                                                                              "Bend your knees, or stand on tiptoe",
                                                                              "Step forward or backward"};
  return kAdvice[static_cast<std::size_t>(motion)];
}

}  // namespace armature::viewer
