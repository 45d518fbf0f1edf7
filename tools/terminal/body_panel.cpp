#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "tools/terminal/braille.h"
#include "tools/terminal/panels.h"

namespace armature::tools {
namespace {

using navproto::JointId;
using navproto::JointState;
using navproto::Vec3;

constexpr std::array<std::pair<JointId, JointId>, 28> kBones = {{
    {JointId::Head, JointId::Neck},
    {JointId::Neck, JointId::Chest},
    {JointId::Chest, JointId::Torso},
    {JointId::Torso, JointId::Waist},
    {JointId::Neck, JointId::LeftCollar},
    {JointId::LeftCollar, JointId::LeftShoulder},
    {JointId::LeftShoulder, JointId::LeftUpperArm},
    {JointId::LeftUpperArm, JointId::LeftElbow},
    {JointId::LeftElbow, JointId::LeftForearm},
    {JointId::LeftForearm, JointId::LeftWrist},
    {JointId::LeftWrist, JointId::LeftHand},
    {JointId::Waist, JointId::LeftHip},
    {JointId::LeftHip, JointId::LeftThigh},
    {JointId::LeftThigh, JointId::LeftKnee},
    {JointId::LeftKnee, JointId::LeftAnkle},
    {JointId::LeftAnkle, JointId::LeftFoot},
    {JointId::Neck, JointId::RightCollar},
    {JointId::RightCollar, JointId::RightShoulder},
    {JointId::RightShoulder, JointId::RightUpperArm},
    {JointId::RightUpperArm, JointId::RightElbow},
    {JointId::RightElbow, JointId::RightForearm},
    {JointId::RightForearm, JointId::RightWrist},
    {JointId::RightWrist, JointId::RightHand},
    {JointId::Waist, JointId::RightHip},
    {JointId::RightHip, JointId::RightThigh},
    {JointId::RightThigh, JointId::RightKnee},
    {JointId::RightKnee, JointId::RightAnkle},
    {JointId::RightAnkle, JointId::RightFoot},
}};

constexpr int kBackgroundLayer = 0;
constexpr int kSurfaceLayer = 1;
constexpr int kBoneLayer = 2;

/// What of a standing person's surroundings is shown, metres about the point of view (her torso's centre).
constexpr double kAbove = 0.95;
constexpr double kBelow = 1.25;

float dot(const Vec3& a, const Vec3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Level axes for a camera that looks up or down: orthonormal, in the camera frame.
struct Axes {
  Vec3 up{0, -1, 0};
  Vec3 right{1, 0, 0};
  Vec3 away{0, 0, 1};
};

Axes level_axes(const Vec3& up) {
  // The camera's x, made level.
  const Vec3 right{1 - up.x * up.x, -up.x * up.y, -up.x * up.z};
  const float length = std::sqrt(dot(right, right));
  if (!(length > 0.1F)) return {};
  const Vec3 unit{right.x / length, right.y / length, right.z / length};
  return {up, unit, cross(up, unit)};
}

/// A parallel, level view: from the front, or from the person's right, facing left.
struct View {
  Axes axes;
  Vec3 anchor;
  Dot centre;  ///< where the anchor is drawn
  double dots_per_metre = 1;
  bool from_side = false;

  [[nodiscard]] Dot operator()(const Vec3& p) const {
    const Vec3 v{p.x - anchor.x, p.y - anchor.y, p.z - anchor.z};
    return {centre.x + dot(v, from_side ? axes.away : axes.right) * dots_per_metre, row(dot(p, axes.up))};
  }
  /// Row of what lies so high along `up`, counted from the camera.
  [[nodiscard]] double row(float height) const { return centre.y - (height - dot(anchor, axes.up)) * dots_per_metre; }
};

Rgb side_colour(JointId joint) {
  const auto i = static_cast<std::size_t>(joint);
  if (i < static_cast<std::size_t>(JointId::LeftCollar)) return palette::kMiddle;
  return i < static_cast<std::size_t>(JointId::RightCollar) ? palette::kLeftSide : palette::kRightSide;
}

Rgb shown_colour(const LiveState& state, JointId joint) {
  const auto& value = state.skeleton->joints[static_cast<std::size_t>(joint)];
  double strength = value.state == JointState::Observed ? 1.0 : value.state == JointState::Inferred ? 0.65 : 0.3;
  if (!state.skeleton->tracking || !state.fresh) strength = 0.25;
  return mixed(palette::kFaint, side_colour(joint), strength);
}

void draw_skeleton(const LiveState& state, const View& view, BrailleCanvas& canvas) {
  const auto at = [&](JointId joint) { return view(state.skeleton->joints[static_cast<std::size_t>(joint)].position); };
  const auto lost = [&](JointId joint) {
    return state.skeleton->joints[static_cast<std::size_t>(joint)].state == JointState::Lost;
  };
  const bool large = view.dots_per_metre >= 34;
  for (const auto& [from, to] : kBones) {
    const int gap = lost(from) || lost(to) ? 3 : 1;
    canvas.line(at(from), at(to), shown_colour(state, to), kBoneLayer, large && gap == 1 ? 2.2 : 1, gap);
  }
  const double head_radius = std::max(2.0, 0.115 * view.dots_per_metre);
  canvas.circle(at(JointId::Head), head_radius, shown_colour(state, JointId::Head), kBoneLayer);
  for (const JointId joint : {JointId::LeftHand, JointId::RightHand, JointId::LeftFoot, JointId::RightFoot,
                              JointId::LeftKnee, JointId::RightKnee, JointId::LeftElbow, JointId::RightElbow,
                              JointId::LeftShoulder, JointId::RightShoulder, JointId::LeftHip, JointId::RightHip}) {
    canvas.disc(at(joint), large ? 2.2 : 1.5, shown_colour(state, joint), kBoneLayer);
  }
}

/// The user's pixels as a relief lit from the upper left: distances are gathered on the grid of dots, shaded by their
/// slope and dithered.
void draw_surface(const navproto::FeedMessage& feed, std::uint32_t user, const View& view, BrailleCanvas& canvas) {
  const int width = canvas.width();
  const int height = canvas.height();
  const auto cell = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  };
  std::vector<float> distance(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
  const auto& k = feed.intrinsics;
  for (int v = 0; v < k.height; ++v) {
    for (int u = 0; u < k.width; ++u) {
      const auto i = static_cast<std::size_t>(v) * static_cast<std::size_t>(k.width) + static_cast<std::size_t>(u);
      if (feed.user_mask[i] != user || feed.depth_mm[i] == 0) continue;
      const double z = feed.depth_mm[i] / 1000.0;
      const Dot at = view({static_cast<float>((u - k.centre_x_px) / k.focal_x_px * z),
                           static_cast<float>((v - k.centre_y_px) / k.focal_y_px * z), static_cast<float>(z)});
      const auto x = static_cast<int>(std::lround(at.x));
      const auto y = static_cast<int>(std::lround(at.y));
      if (x < 0 || y < 0 || x >= width || y >= height) continue;
      float& nearest = distance[cell(x, y)];
      if (nearest == 0 || z < nearest) nearest = static_cast<float>(z);
    }
  }
  // Ordered dithering, Bayer's 4x4 matrix.
  static constexpr std::array<std::array<int, 4>, 4> kBayer = {
      {{0, 8, 2, 10}, {12, 4, 14, 6}, {3, 11, 1, 9}, {15, 7, 13, 5}}};
  constexpr Rgb kFar{40, 62, 88};
  constexpr Rgb kNear{92, 132, 170};
  const double metres_per_dot = 1 / view.dots_per_metre;
  for (int y = 1; y < height; ++y) {
    for (int x = 1; x < width; ++x) {
      const float z = distance[cell(x, y)];
      if (z == 0) continue;
      const float left = distance[cell(x - 1, y)];
      const float up = distance[cell(x, y - 1)];
      const double slope_x = left == 0 ? 0 : std::clamp((z - left) / metres_per_dot, -2.0, 2.0);
      const double slope_y = up == 0 ? 0 : std::clamp((z - up) / metres_per_dot, -2.0, 2.0);
      // Lambert's law for the normal (slope_x, slope_y, -1) and light from the upper left, in front.
      const double light =
          (0.62 - 0.45 * slope_x * -1 - 0.35 * slope_y * -1) / std::sqrt(1 + slope_x * slope_x + slope_y * slope_y);
      const double threshold = (kBayer[static_cast<std::size_t>(y % 4)][static_cast<std::size_t>(x % 4)] + 0.5) / 16;
      if (light < threshold) continue;
      canvas.dot({static_cast<double>(x), static_cast<double>(y)}, mixed(kNear, kFar, (z - view.anchor.z + 0.4) / 0.8),
                 kSurfaceLayer);
    }
  }
}

void draw_floor(const LiveState& state, const View& view, Dot from, Dot to, BrailleCanvas& canvas) {
  if (!state.floor_height) return;
  const double y = view.row(*state.floor_height) + 2;
  canvas.line({from.x, y}, {to.x, y}, palette::kFrame, kBackgroundLayer, 1, 3);
}

}  // namespace

void draw_body(const LiveState& state, Screen& screen, const Area& area) {
  const Area inside = draw_frame(screen, area, "body");
  if (inside.width < 8 || inside.height < 4) return;
  if (!state.skeleton) {
    screen.put(inside.column + 2, inside.row + inside.height / 2, "nobody yet", {palette::kDim, false}, inside.width);
    return;
  }
  BrailleCanvas canvas(inside.width, inside.height);
  const double scale = canvas.height() / (kAbove + kBelow);
  const bool both = canvas.width() >= 1.55 * scale;
  const double front_share = both ? 0.62 : 1.0;
  const double anchor_row = canvas.height() * kAbove / (kAbove + kBelow);
  const Axes axes = level_axes(state.skeleton->user_up);
  const View front{axes, state.anchor, {canvas.width() * front_share / 2, anchor_row}, scale, false};
  const View side{axes, state.anchor, {canvas.width() * (1 + front_share) / 2, anchor_row}, scale, true};

  const bool surface = state.feed && state.navigation && state.fresh;
  if (surface) draw_surface(*state.feed, state.navigation->user_id, front, canvas);
  draw_floor(state, front, {3, 0}, {canvas.width() * front_share - 3, 0}, canvas);
  draw_skeleton(state, front, canvas);
  if (both) {
    draw_floor(state, side, {canvas.width() * front_share + 3, 0}, {canvas.width() - 3.0, 0}, canvas);
    draw_skeleton(state, side, canvas);
  }
  canvas.draw_on(screen, inside.column, inside.row);
  const int last = inside.row + inside.height - 1;
  screen.put(inside.column + 1, last, "front", {palette::kDim, false});
  if (both) screen.put(inside.column + inside.width - 5, last, "side", {palette::kDim, false});
}

}  // namespace armature::tools
