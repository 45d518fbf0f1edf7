#include "viewer/app/gestures.h"

#include <algorithm>
#include <numbers>
#include <optional>

#include <armature/sdk/selection/boundary.h>
#include <armature/sdk/selection/patch_brush.h>

namespace armature::viewer {

ViewPoint view_point(const Ui& ui, const ImVec2& pixel) {
  const Area& view = ui.view;
  const float half = view.size.y / 2;
  return {(pixel.x - view.at.x - view.size.x / 2) / half, (view.at.y + half - pixel.y) / half};
}

void issue_camera(Ui& ui, const OrbitCamera& c) {
  ui.issue("camera {:.6g} {:.6g} {:.9g} {:.9g} {:.9g} {:.9g}", c.view.azimuth_rad * 180 / std::numbers::pi,
           c.view.elevation_rad * 180 / std::numbers::pi, c.distance, c.target.x(), c.target.y(), c.target.z());
}

namespace {

/// What the gesture that goes on would select.
struct Live {
  std::weak_ptr<Model> model = {};
  std::shared_ptr<const MeshShape> mesh = {};  // that it began on
  std::optional<sdk::PatchBrush> brush = {};
  sdk::Brush kind = sdk::Brush::Patch;
  std::optional<Eigen::Vector3d> from = {}, to = {};  // of a boundary that is dragged
};

Live live;

/// On a larger mesh the new boundary is shown after the drag alone: finding it takes longer than a frame.
constexpr std::size_t kMostFacesDragged = 200'000;

std::string words_of(const Eigen::Vector3d& point) {
  return fmt::format("{:.9g} {:.9g} {:.9g}", point.x(), point.y(), point.z());
}

/// In the model's unit.
double brush_radius(const Ui& ui) {
  return ui.session.brush * 2 * ui.session.around().radius;
}

/// The points of a stroke on the surface, as words; those beside the model are left out.
std::string stroke_on_surface(Ui& ui, std::size_t& count) {
  std::string words;
  count = 0;
  const std::size_t step = std::max<std::size_t>(1, ui.stroke.size() / 64);
  for (std::size_t i = 0; i < ui.stroke.size(); i += step) {
    const auto found = ui.session.pick(view_point(ui, ui.stroke[i]));
    if (!found || !found->face.valid()) continue;
    words += fmt::format(" {}", words_of(found->point));
    ++count;
  }
  return words;
}

/// The vertex nearest to what is seen there.
std::optional<sdk::VertexId> vertex_at(Ui& ui, const ImVec2& pixel) {
  const auto found = ui.session.pick(view_point(ui, pixel));
  if (!found || !found->face.valid()) return std::nullopt;
  const sdk::Mesh& mesh = ui.session.models[ui.session.active_model]->mesh->mesh;
  return std::ranges::min(mesh.triangle(found->face), {},
                          [&](sdk::VertexId v) { return (mesh.position(v) - found->point).squaredNorm(); });
}

/// What is seen of the mesh there.
std::optional<Eigen::Vector3d> point_at(Ui& ui, const ImVec2& pixel) {
  const auto found = ui.session.pick(view_point(ui, pixel));
  return found && found->face.valid() ? std::optional(found->point) : std::nullopt;
}

void end_tool_drag(Ui& ui) {
  Session& session = ui.session;
  const ImGuiIO& io = ImGui::GetIO();
  if (session.tool == Tool::Click) {
    const auto found = session.pick(view_point(ui, io.MousePos));
    if (found && found->face.valid()) ui.issue("click {}", found->face.index());
  } else if (session.tool == Tool::Spot) {
    if (const auto vertex = vertex_at(ui, io.MousePos))
      ui.issue("similarity {} {}", kLikenesses[static_cast<std::size_t>(ui.like_by)], vertex->index());
  } else if (session.tool == Tool::Lasso) {
    if (ui.stroke.size() < 3) return;
    std::string words;
    const std::size_t step = std::max<std::size_t>(1, ui.stroke.size() / 128);
    for (std::size_t i = 0; i < ui.stroke.size(); i += step) {
      const ViewPoint at = view_point(ui, ui.stroke[i]);
      words += fmt::format(" {:.5g} {:.5g}", at.x(), at.y());
    }
    issue_camera(ui, session.camera);  // what a loop holds depends on it
    ui.issue("lasso{}", words);
  } else if (session.tool == Tool::Edge) {
    if (session.models[session.active_model]->selecting.reference.empty()) {
      session.tell("select a region first; then drag its boundary");
    } else if (live.from && live.to) {
      ui.issue("drag-edge {} {}", words_of(*live.from), words_of(*live.to));
    }
  } else if (session.tool != Tool::Pose) {
    std::size_t count = 0;
    const std::string words = stroke_on_surface(ui, count);
    if (count == 0) {
      session.tell("that stroke was beside the model; begin on it");
    } else if (session.tool == Tool::Cut) {
      ui.issue("cut {}{}", io.KeyShift ? "add" : "new", words);
    } else if (session.tool == Tool::Brush) {
      ui.issue("brush {} {:.6g}{}", io.KeyShift ? "add" : io.KeyCtrl ? "background" : "new", brush_radius(ui), words);
    }
  }
}

void show(Model& model, std::vector<sdk::FaceId> faces) {
  if (model.selecting.drawn == faces) return;
  model.selecting.drawn = std::move(faces);
  ++model.colour_revision;
}

/// A brush that has drawn the strokes before, where the new one goes on with them.
void begin_brush(Ui& ui, const Model& model) {
  const ImGuiIO& io = ImGui::GetIO();
  const sdk::Surface& surface = model.mesh->surface;
  live.brush.emplace(surface, brush_radius(ui));
  live.kind = io.KeyCtrl && !io.KeyShift ? sdk::Brush::Background : sdk::Brush::Patch;
  if ((!io.KeyShift && !io.KeyCtrl) || model.selecting.kind != Selecting::Kind::Patch) return;
  const auto draw = [&](const auto& strokes, sdk::Brush kind) {
    for (const auto& stroke : strokes) {
      live.brush->lift();
      for (const Eigen::Vector3d& point : stroke) live.brush->draw_to(surface.tree.closest(point), kind);
    }
  };
  draw(model.selecting.strokes.strokes, sdk::Brush::Patch);
  draw(model.selecting.strokes.background, sdk::Brush::Background);
  live.brush->lift();
}

}  // namespace

void begin_gesture(Ui& ui) {
  Session& session = ui.session;
  const std::shared_ptr<Model>& model = session.models[session.active_model];
  ui.stroke.clear();
  live = {.model = model, .mesh = model->mesh};
  if (model->mesh && !session.job.running()) {
    if (session.tool == Tool::Brush) begin_brush(ui, *model);
    if (session.tool == Tool::Edge) live.from = point_at(ui, ImGui::GetIO().MousePos);
  }
  continue_gesture(ui);
}

void continue_gesture(Ui& ui) {
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  ui.stroke.push_back(mouse);
  const auto model = live.model.lock();
  if (!model || model->mesh != live.mesh || (!live.brush && !live.from)) return;
  const auto point = point_at(ui, mouse);
  if (!point) return;
  const sdk::Surface& surface = model->mesh->surface;
  const sdk::SurfacePoint to = surface.tree.closest(*point);
  if (live.brush) {
    live.brush->draw_to(to, live.kind);
    show(*model, live.brush->faces());
  } else if (!model->selecting.reference.empty()) {
    live.to = point;
    if (surface.mesh.triangles.size() > kMostFacesDragged) return ui.session.tell("let go to see the new boundary");
    const auto drag = boundary_drag(surface, surface.tree.closest(*live.from), to, 0);
    show(*model, sdk::drag_boundary(surface, model->selecting.reference, drag));
  }
}

void end_gesture(Ui& ui) {
  if (const auto model = live.model.lock()) show(*model, {});
  end_tool_drag(ui);
  live = {};
  ui.stroke.clear();
}

}  // namespace armature::viewer
