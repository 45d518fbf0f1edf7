// What moves the spheres that are held: three arrows along the axes, a disc across the view, a ring that turns about
// the line of sight, a square that scales, a diamond that swells.
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>

#include <Eigen/Geometry>

#include "viewer/app/gestures.h"
#include "viewer/app/theme.h"
#include "viewer/session/posing.h"

namespace armature::viewer {
namespace {

using Eigen::Vector3d;

enum class Grip { None, X, Y, Z, View, Ring, Scale, Swell };

}  // namespace

/// A grip that is being dragged: whose, where it began, and what it does so far. What that would look like is found in
/// the background, late by one step; it is shown until the command that the drag becomes has been carried out. While a
/// job of the session runs nothing else is shown.
struct GizmoDrag {
  Grip grip = Grip::None;
  ImVec2 from{0, 0};
  sdk::Sphere middle = {};  // of what is held, when it began
  sdk::SphereMove move = {};
  std::weak_ptr<Model> model = {};
  std::vector<sdk::SphereId> held = {};
  bool moved = false;      // since a preview was begun
  std::size_t number = 0;  // of the drag
  Job previewing = {};
};

namespace {

ImVec2 pixel(const Ui& ui, const Vector3d& point) {
  const ViewPoint at = ui.session.camera.project(point);
  const double half = static_cast<double>(ui.view.size.y) / 2;
  return {static_cast<float>(static_cast<double>(ui.view.at.x + ui.view.size.x / 2) + half * at.x()),
          static_cast<float>(static_cast<double>(ui.view.at.y) + half * (1 - at.y()))};
}

float distance(const ImVec2& a, const ImVec2& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

/// The middle of what is held, and its mean radius.
sdk::Sphere held(const Model& model) {
  sdk::Sphere middle{Vector3d::Zero(), 0};
  for (const sdk::SphereId id : model.handle) {
    middle.centre += model.spheres->shape->sphere(id).centre;
    middle.radius += model.spheres->shape->sphere(id).radius;
  }
  const auto count = static_cast<double>(model.handle.size());
  return {middle.centre / count, middle.radius / count};
}

/// What a grip that was dragged from one pixel to another does.
sdk::SphereMove move_of(const Ui& ui, const std::vector<sdk::SphereId>& spheres, const sdk::Sphere& middle, Grip grip,
                        const ImVec2& from, const ImVec2& to) {
  const OrbitCamera& camera = ui.session.camera;
  const Eigen::Isometry3d view = camera.view_from_world();
  const double depth = -(view * middle.centre).z();
  // Model units a pixel, at the middle's depth.
  const double unit = 2 * OrbitCamera::kHalfHeight * depth / static_cast<double>(ui.view.size.y);
  const Eigen::Vector2d by(static_cast<double>(to.x - from.x), static_cast<double>(from.y - to.y));
  sdk::SphereMove move{.spheres = spheres};
  switch (grip) {
    case Grip::View: move.translate = view.linear().transpose() * Vector3d(unit * by.x(), unit * by.y(), 0); break;
    case Grip::X:
    case Grip::Y:
    case Grip::Z: {
      Vector3d axis = Vector3d::Zero();
      axis[static_cast<int>(grip) - static_cast<int>(Grip::X)] = 1;
      const Eigen::Vector2d seen = (view.linear() * axis).head<2>();
      // An axis towards the eye cannot be dragged along.
      if (seen.norm() > 0.05) move.translate = unit * by.dot(seen) / seen.squaredNorm() * axis;
      break;
    }
    case Grip::Ring: {
      const ImVec2 centre = pixel(ui, middle.centre);
      const double before = std::atan2(static_cast<double>(centre.y - from.y), static_cast<double>(from.x - centre.x));
      const double after = std::atan2(static_cast<double>(centre.y - to.y), static_cast<double>(to.x - centre.x));
      const double angle = std::remainder(after - before, 2 * std::numbers::pi);
      move.rotate = angle * (camera.eye() - middle.centre).normalized();
      break;
    }
    case Grip::Scale: move.scale = std::exp2(std::clamp((by.x() + by.y()) / 120, -4.0, 4.0)); break;
    case Grip::Swell: move.radius = middle.radius * std::exp2(std::clamp((by.x() + by.y()) / 120, -4.0, 4.0)); break;
    case Grip::None: break;
  }
  return move;
}

void issue(Ui& ui, Grip grip, const sdk::SphereMove& move) {
  const auto& t = move.translate;
  if (grip == Grip::Ring) {
    if (move.rotate.norm() < 1e-6) return;
    const Vector3d axis = move.rotate.normalized();
    ui.issue("rotate {:.6g} {:.6g} {:.6g} {:.5g}", axis.x(), axis.y(), axis.z(),
             move.rotate.norm() * 180 / std::numbers::pi);
  } else if (grip == Grip::Scale) {
    ui.issue("scale {:.5g}", move.scale);
  } else if (grip == Grip::Swell) {
    ui.issue("swell {:.6g}", *move.radius);
  } else if (t.norm() > 0) {
    ui.issue("translate {:.7g} {:.7g} {:.7g}", t.x(), t.y(), t.z());
  }
}

/// Chooses the sphere, edge or triangle under the mouse; Shift adds to what is held.
void choose(Ui& ui, Model& model) {
  const ImGuiIO& io = ImGui::GetIO();
  const auto hit = model.sphere_tree().intersect(ui.session.camera.ray(view_point(ui, io.MousePos)));
  if (!hit) return;
  std::set<std::size_t> chosen;
  if (io.KeyShift)
    for (const sdk::SphereId id : model.handle) chosen.insert(id.index());
  // Near a sphere it alone is meant.
  const double most = hit->weights.maxCoeff();
  for (std::size_t i = 0; i < 3; ++i) {
    const double weight = hit->weights[static_cast<Eigen::Index>(i)];
    if (hit->spheres[i].valid() && weight > 0 && (most < 0.85 || weight == most))
      chosen.insert(hit->spheres[i].index());
  }
  ui.issue("handle {}", fmt::join(chosen, " "));
}

bool poses(const Session& session) {
  return session.mode == Mode::Shapes && session.tool == Tool::Pose;
}

/// A drag ends where what it held is held no longer: by an undo, another tool or model.
void drop_stale_drag(const Session& session, GizmoDrag& drag) {
  if (drag.grip == Grip::None || session.job.running()) return;
  const auto model = drag.model.lock();
  const bool active = model && !session.models.empty() && session.models[session.active_model] == model;
  if (!active || !model->posing || !poses(session) || model->handle != drag.held) drag.grip = Grip::None;
}

}  // namespace

bool handle_gizmo(Ui& ui, bool over) {
  const Session& session = ui.session;
  if (!ui.drag) ui.drag = std::make_shared<GizmoDrag>();
  GizmoDrag& drag = *ui.drag;
  drop_stale_drag(session, drag);
  if (!poses(session) || session.models.empty() || !session.models[session.active_model]->posing) return false;
  Model& model = *session.models[session.active_model];
  const ImGuiIO& io = ImGui::GetIO();
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  if (session.job.running()) return drag.grip != Grip::None;

  for (const sdk::SphereId id : model.handle) {
    const sdk::Sphere& sphere = model.spheres->shape->sphere(id);
    draw.AddCircleFilled(pixel(ui, sphere.centre), ui.px(6), theme::kAccent);
  }
  if (!model.handle.empty()) {
    const sdk::Sphere middle = held(model);
    const ImVec2 centre = pixel(ui, middle.centre);
    const float reach = std::min(ui.px(74), 0.16F * ui.view.size.y);
    std::array<std::pair<Grip, ImVec2>, 6> grips;
    const Eigen::Matrix3d rotation = session.camera.view_from_world().linear();
    static constexpr std::array<ImU32, 3> kAxes = {IM_COL32(198, 70, 58, 255), IM_COL32(74, 148, 74, 255),
                                                   IM_COL32(58, 104, 190, 255)};
    for (int axis = 0; axis < 3; ++axis) {
      const ImVec2 end(centre.x + reach * static_cast<float>(rotation(0, axis)),
                       centre.y - reach * static_cast<float>(rotation(1, axis)));
      draw.AddLine(centre, end, kAxes[static_cast<std::size_t>(axis)], ui.px(3));
      draw.AddCircleFilled(end, ui.px(6), kAxes[static_cast<std::size_t>(axis)]);
      grips[static_cast<std::size_t>(axis)] = {static_cast<Grip>(axis + 1), end};
    }
    draw.AddCircle(centre, 1.25F * reach, theme::kDim, 64, ui.px(2.5F));
    const ImVec2 square(centre.x + 0.95F * reach, centre.y - 0.95F * reach);
    const ImVec2 diamond(centre.x - 0.95F * reach, centre.y - 0.95F * reach);
    draw.AddRectFilled({square.x - ui.px(6), square.y - ui.px(6)}, {square.x + ui.px(6), square.y + ui.px(6)},
                       theme::kInk, ui.px(2));
    draw.AddNgonFilled(diamond, ui.px(8), theme::kInk, 4);
    draw.AddCircleFilled(centre, ui.px(8), IM_COL32(255, 255, 255, 230));
    draw.AddCircle(centre, ui.px(8), theme::kInk, 0, ui.px(2));
    grips[3] = {Grip::View, centre};
    grips[4] = {Grip::Scale, square};
    grips[5] = {Grip::Swell, diamond};
    if (over && drag.grip == Grip::None && io.MouseClicked[0] && !io.KeyAlt) {
      for (const auto& [grip, at] : grips)
        if (distance(io.MousePos, at) < ui.px(11)) drag.grip = grip;
      if (drag.grip == Grip::None && std::abs(distance(io.MousePos, centre) - 1.25F * reach) < ui.px(7))
        drag.grip = Grip::Ring;
      if (drag.grip != Grip::None) {
        drag.from = io.MousePos;
        drag.middle = middle;
        drag.move = {};
        drag.model = session.models[session.active_model];
        drag.held = model.handle;
        ++drag.number;
      }
    }
    if (drag.grip != Grip::None && (io.MouseDelta.x != 0 || io.MouseDelta.y != 0)) {
      drag.move = move_of(ui, drag.held, drag.middle, drag.grip, drag.from, io.MousePos);
      drag.moved = true;
    }
    if (drag.grip != Grip::None && !io.MouseDown[0]) {
      const Grip grip = std::exchange(drag.grip, Grip::None);
      if (!drag.move.spheres.empty()) issue(ui, grip, drag.move);
      return true;
    }
    if (drag.grip != Grip::None) return true;
  }
  if (over && io.MouseClicked[0] && !io.KeyAlt) {
    choose(ui, model);
    return true;
  }
  return false;
}

bool follow_gizmo(Ui& ui) {
  if (!ui.drag) return false;
  GizmoDrag& drag = *ui.drag;
  // A job may be reading what a preview would change.
  if (ui.session.job.running()) return drag.previewing.running();
  const auto model = drag.model.lock();
  const bool posed = model && model->posing;
  if (!posed) drag.previewing.cancel();
  static_cast<void>(drag.previewing.poll());
  if (!posed) return drag.previewing.running();
  if (drag.grip == Grip::None) {
    // What it showed stays until what it did takes its place.
    drag.moved = false;
    if (model->previewed && !drag.previewing.running()) model->preview(nullptr);
    return drag.previewing.running();
  }
  if (drag.previewing.running()) return true;
  if (!drag.moved) return false;
  drag.moved = false;
  drag.previewing.start("following",
                        [&drag, model, posing = model->posing, move = drag.move,
                         number = drag.number](const sdk::Task&) -> sdk::Expected<Job::Apply> {
                          auto laid = posing->preview(move);
                          if (!laid) return tl::unexpected(laid.error());
                          return Job::Apply([&drag, model, number, pose = std::move(*laid)] {
                            if (drag.grip != Grip::None && drag.number == number) model->preview(pose);
                          });
                        });
  return true;
}

}  // namespace armature::viewer
