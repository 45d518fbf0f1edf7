#include "viewer/app/gestures.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <utility>

#include <armature/sdk/selection/boundary.h>
#include <armature/sdk/selection/patch_brush.h>

namespace armature::viewer {
namespace {

using Faces = std::vector<sdk::FaceId>;
using Points = std::vector<Eigen::Vector3d>;

/// Says what a gesture would select that has gone on through more points. Called by one thread at a time.
using Follower = std::function<sdk::Expected<Faces>(const Points&, const sdk::Task&)>;

/// A line that waits for the gesture before, and what it was drawn with.
struct Waiting {
  std::string line;
  std::weak_ptr<Model> model;
  OrbitCamera camera;  // that a loop was seen with
  sdk::Combine combine;
  bool refines;  // goes on from the gesture before
};

}  // namespace

/// What the tool in hand does. What it would select is found in the background: the points that were drawn meanwhile
/// are taken together, so it keeps up however large the mesh is.
struct Gesture {
  std::weak_ptr<Model> model = {};             ///< that it began on
  Tool tool = Tool::Look;                      ///< that it began with
  const char* how = "new";                     ///< as its command says it
  double radius = 0;                           ///< of the brush that it began with
  Points points = {};                          ///< on the surface, that its command will hold
  bool drawing = false;                        ///< it goes on
  bool lost = false;                           ///< what it goes on from was cancelled meanwhile
  std::size_t followed = 0;                    ///< how many of the points the follower has been told
  std::shared_ptr<const Follower> follower{};  ///< or none
  Faces shown = {};                            ///< what it has found last
  Job following = {};                          ///< may still be about a gesture before
  std::shared_ptr<const Outcome> before{};     ///< of the gesture before, while its job runs; or none
  std::vector<Waiting> waiting = {};           ///< for it: what was drawn meanwhile
};

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

constexpr const char* kLasso = "lasso";
/// A point of a stroke is so far from the one before, in units of layout.
constexpr float kStep = 4;

std::string words_of(const Eigen::Vector3d& point) {
  return fmt::format("{:.9g} {:.9g} {:.9g}", point.x(), point.y(), point.z());
}

std::string words_of(const Points& points) {
  std::string words;
  for (const Eigen::Vector3d& point : points) words += ' ' + words_of(point);
  return words;
}

/// In the model's unit.
double brush_radius(const Ui& ui) {
  return ui.session.brush * 2 * ui.session.around().radius;
}

/// The vertex nearest to what is seen there.
std::optional<sdk::VertexId> vertex_at(Ui& ui, const ImVec2& pixel) {
  const auto found = ui.session.pick(view_point(ui, pixel));
  if (!found || !found->face.valid()) return std::nullopt;
  const sdk::Mesh& mesh = ui.session.models[ui.session.active_model]->mesh->mesh;
  return std::ranges::min(mesh.triangle(found->face), {},
                          [&](sdk::VertexId v) { return (mesh.position(v) - found->point).squaredNorm(); });
}

/// Whether a gesture changes what the one before has selected.
bool refines(const Gesture& gesture) {
  return gesture.tool == Tool::Edge || std::string_view(gesture.how) != "new";
}

/// Notices that the gesture before has been selected, or not: then what goes on from it goes, too.
void settle(Ui& ui) {
  Gesture& gesture = *ui.gesture;
  if (!gesture.before || *gesture.before == Outcome::Open) return;
  if (*std::exchange(gesture.before, nullptr) == Outcome::Done) return;
  const auto kept = std::ranges::find_if(gesture.waiting, [](const Waiting& drawn) { return !drawn.refines; });
  auto lost = kept - gesture.waiting.begin();
  gesture.waiting.erase(gesture.waiting.begin(), kept);
  if (gesture.drawing && gesture.waiting.empty() && refines(gesture)) {
    gesture.lost = true;
    ++lost;
  }
  if (lost > 0)
    ui.tell_also(lost == 1 ? "; the stroke that went on from it went with it"
                           : fmt::format("; the {} strokes that went on from it went with it", lost));
}

/// Issues the command of a gesture now.
void issue_now(Ui& ui, const std::string& line) {
  const auto before = ui.session.job_outcome;
  ui.issue("{}", line);
  ui.gesture->before = ui.session.job_outcome == before ? nullptr : ui.session.job_outcome;
}

/// The same once those of the gestures before are done.
void issue_gesture_line(Ui& ui, std::string line) {
  Gesture& gesture = *ui.gesture;
  if (!gesture.before && gesture.waiting.empty()) return issue_now(ui, line);
  gesture.waiting.push_back({std::move(line), gesture.model, ui.session.camera, ui.session.combine, refines(gesture)});
}

/// Issues what has waited, as it was drawn: from where the camera stood then, combined as was chosen then.
void issue_waiting(Ui& ui, const Waiting& drawn) {
  const OrbitCamera camera = ui.session.camera;
  const sdk::Combine combine = ui.session.combine;
  const auto choose = [&](sdk::Combine how) {
    if (how != ui.session.combine) ui.issue("combine {}", kCombines[static_cast<std::size_t>(how)]);
  };
  const bool seen = drawn.line.starts_with(kLasso);
  choose(drawn.combine);
  if (seen) issue_camera(ui, drawn.camera);
  issue_now(ui, drawn.line);
  if (seen) issue_camera(ui, camera);
  choose(combine);
}

void lasso(Ui& ui) {
  if (ui.stroke.size() < 3) return;
  std::string words;
  const std::size_t step = std::max<std::size_t>(1, ui.stroke.size() / 128);
  for (std::size_t i = 0; i < ui.stroke.size(); i += step) {
    const ViewPoint at = view_point(ui, ui.stroke[i]);
    words += fmt::format(" {:.5g} {:.5g}", at.x(), at.y());
  }
  issue_camera(ui, ui.session.camera);  // what a loop holds depends on it
  issue_gesture_line(ui, kLasso + words);
}

/// The command that the gesture was.
void issue_gesture(Ui& ui, const Gesture& gesture) {
  const Session& session = ui.session;
  if (session.models.empty() || gesture.model.lock() != session.models[session.active_model])
    return ui.tell("another model came up meanwhile; draw again");
  if (session.models[session.active_model]->posing && gesture.tool != Tool::Pose) return ui.tell(kPutBackFirst);
  const Points& points = gesture.points;
  const bool beside = points.empty();
  const auto miss = [&] { ui.tell("that stroke was beside the model; begin on it"); };
  switch (gesture.tool) {
    case Tool::Click:
      if (const auto found = session.pick(view_point(ui, ImGui::GetIO().MousePos)); found && found->face.valid())
        issue_gesture_line(ui, fmt::format("click {}", found->face.index()));
      return;
    case Tool::Spot:
      if (const auto vertex = vertex_at(ui, ImGui::GetIO().MousePos))
        issue_gesture_line(
            ui, fmt::format("similarity {} {}", kLikenesses[static_cast<std::size_t>(ui.like_by)], vertex->index()));
      return;
    case Tool::Lasso: return lasso(ui);
    case Tool::Edge:
      if (session.models[session.active_model]->selecting.reference.empty() && !gesture.before)
        return ui.tell("select a region first; then drag its boundary");
      if (points.size() > 1)
        issue_gesture_line(ui, fmt::format("drag-edge {} {}", words_of(points.front()), words_of(points.back())));
      return;
    case Tool::Cut:
      return beside ? miss() : issue_gesture_line(ui, fmt::format("cut {}{}", gesture.how, words_of(points)));
    case Tool::Brush:
      return beside ? miss()
                    : issue_gesture_line(
                          ui, fmt::format("brush {} {:.6g}{}", gesture.how, gesture.radius, words_of(points)));
    case Tool::Look:
    case Tool::Pose: return;
  }
}

void show(Model& model, Faces faces) {
  if (model.selecting.drawn == faces) return;
  model.selecting.drawn = std::move(faces);
  ++model.colour_revision;
}

Follower cut_follower(const Model& model, bool again) {
  const auto before = again && model.selecting.kind == Selecting::Kind::Part ? model.selecting.cut : nullptr;
  return [mesh = model.mesh, before, parts = std::shared_ptr<const sdk::PartModel>(),
          cut = std::optional<sdk::PartCut>()](const Points& points, const sdk::Task& task) mutable {
    if (!cut) {
      auto made = mesh->parts(task);
      if (!made) return sdk::Expected<Faces>(tl::unexpected(made.error()));
      parts = std::move(*made);
      cut.emplace(before ? sdk::PartCut(*before) : sdk::PartCut(*parts));
      cut->begin_stroke();
    }
    for (const Eigen::Vector3d& point : points) cut->add_point(mesh->surface.tree.closest(point));
    return cut->faces();
  };
}

Follower brush_follower(const Model& model, double radius, bool again, sdk::Brush kind) {
  const bool goes_on = again && model.selecting.kind == Selecting::Kind::Patch;
  return [mesh = model.mesh, radius, kind, before = goes_on ? model.selecting.strokes : sdk::PatchStrokes(),
          brush = std::optional<sdk::PatchBrush>()](const Points& points, const sdk::Task&) mutable {
    const auto draw = [&](const Points& stroke, sdk::Brush as) {
      for (const Eigen::Vector3d& point : stroke) brush->draw_to(mesh->surface.tree.closest(point), as);
    };
    if (!brush) {
      brush.emplace(mesh->surface, radius);
      for (const Points& stroke : before.strokes) draw(stroke, sdk::Brush::Patch), brush->lift();
      for (const Points& stroke : before.background) draw(stroke, sdk::Brush::Background), brush->lift();
    }
    draw(points, kind);
    return sdk::Expected<Faces>(brush->faces());
  };
}

Follower edge_follower(const Model& model) {
  return [mesh = model.mesh, reference = model.selecting.reference, from = std::optional<sdk::SurfacePoint>()](
             const Points& points, const sdk::Task& task) mutable -> sdk::Expected<Faces> {
    const sdk::Surface& surface = mesh->surface;
    const sdk::SurfacePoint to = surface.tree.closest(points.back());
    if (!from) from = surface.tree.closest(points.front());
    return sdk::drag_boundary(surface, reference, boundary_drag(surface, *from, to, 0), task);
  };
}

/// What a gesture selects, if that is to be seen while it is drawn.
std::optional<Follower> follower(const Gesture& gesture, const Model& model) {
  const std::string_view how = gesture.how;
  switch (gesture.tool) {
    case Tool::Cut: return cut_follower(model, how == "add");
    case Tool::Brush:
      return brush_follower(model, gesture.radius, how != "new",
                            how == "background" ? sdk::Brush::Background : sdk::Brush::Patch);
    case Tool::Edge:
      if (model.selecting.reference.empty()) return std::nullopt;
      return edge_follower(model);
    default: return std::nullopt;
  }
}

/// Whether what a gesture goes on from is there: it begins anew, or all gestures before have been selected.
bool can_be_followed(const Session& session, const Gesture& gesture) {
  if (gesture.lost) return false;
  if (!session.job.running()) return gesture.waiting.empty();
  return gesture.before && gesture.tool != Tool::Edge && std::string_view(gesture.how) == "new";
}

/// Draws on to where the mouse is.
void draw_on(Ui& ui, const ImVec2& mouse) {
  ui.stroke.push_back(mouse);
  const Tool tool = ui.gesture->tool;
  if (tool != Tool::Cut && tool != Tool::Brush && tool != Tool::Edge) return;
  const auto found = ui.session.pick(view_point(ui, mouse));
  if (found && found->face.valid()) ui.gesture->points.push_back(found->point);
}

}  // namespace

void begin_gesture(Ui& ui) {
  const Session& session = ui.session;
  const ImGuiIO& io = ImGui::GetIO();
  const std::shared_ptr<Model>& model = session.models[session.active_model];
  if (!ui.gesture) ui.gesture = std::make_shared<Gesture>();
  Gesture& gesture = *ui.gesture;
  gesture.model = model;
  gesture.tool = session.tool;
  gesture.how = io.KeyShift ? "add" : io.KeyCtrl && session.tool == Tool::Brush ? "background" : "new";
  gesture.radius = brush_radius(ui);
  gesture.points.clear();
  gesture.drawing = true;
  gesture.lost = false;
  gesture.followed = 0;
  gesture.follower.reset();
  gesture.shown.clear();
  ui.stroke.clear();
  draw_on(ui, io.MousePos);
}

void continue_gesture(Ui& ui) {
  const ImVec2 mouse = ImGui::GetIO().MousePos, last = ui.stroke.back();
  if (std::hypot(mouse.x - last.x, mouse.y - last.y) >= ui.px(kStep)) draw_on(ui, mouse);
}

void end_gesture(Ui& ui) {
  const ImVec2 mouse = ImGui::GetIO().MousePos, last = ui.stroke.back();
  if (mouse.x != last.x || mouse.y != last.y) draw_on(ui, mouse);
  ui.gesture->follower.reset();
  ui.gesture->following.cancel();
  settle(ui);
  if (!ui.gesture->lost) issue_gesture(ui, *ui.gesture);
  ui.gesture->drawing = false;
  ui.stroke.clear();
}

namespace {

bool follow_stroke(Ui& ui) {
  if (!ui.gesture) return false;
  Gesture& gesture = *ui.gesture;
  static_cast<void>(gesture.following.poll());
  const auto model = gesture.model.lock();
  if (gesture.drawing && !gesture.follower && model && model->mesh && can_be_followed(ui.session, gesture))
    if (auto made = follower(gesture, *model)) gesture.follower = std::make_shared<const Follower>(std::move(*made));
  if (!gesture.follower) {
    // What it showed stays until the selection takes its place.
    if (model && !ui.session.job.running()) show(*model, {});
    return false;
  }
  // The gesture before has been selected meanwhile.
  if (model && model->selecting.drawn.empty()) show(*model, gesture.shown);
  if (gesture.following.running()) return true;
  if (!model || gesture.followed == gesture.points.size()) return false;
  const auto first = gesture.points.begin() + static_cast<std::ptrdiff_t>(gesture.followed);
  gesture.followed = gesture.points.size();
  gesture.following.start("following",
                          [&gesture, model, follower = gesture.follower, points = Points(first, gesture.points.end())](
                              const sdk::Task& task) -> sdk::Expected<Job::Apply> {
                            auto faces = (*follower)(points, task);
                            if (!faces) return tl::unexpected(faces.error());
                            return Job::Apply([&gesture, model, follower, faces = std::move(*faces)] {
                              if (gesture.follower != follower) return;
                              gesture.shown = faces;
                              show(*model, faces);
                            });
                          });
  return true;
}

}  // namespace

bool follow_gesture(Ui& ui) {
  if (ui.gesture) settle(ui);
  if (ui.gesture && !ui.gesture->waiting.empty() && !ui.session.job.running()) {
    Gesture& gesture = *ui.gesture;
    const Waiting drawn = std::move(gesture.waiting.front());
    gesture.waiting.erase(gesture.waiting.begin());
    if (ui.session.models.empty() || drawn.model.lock() != ui.session.models[ui.session.active_model]) {
      ui.tell(gesture.waiting.empty()
                  ? "another model came up before the stroke could be carried out; draw it again"
                  : fmt::format("another model came up before {} strokes could be carried out; draw "
                                "them again",
                                gesture.waiting.size() + 1));
      gesture.waiting.clear();
    } else {
      issue_waiting(ui, drawn);
    }
  }
  const bool pose = follow_gizmo(ui);
  return follow_stroke(ui) || pose;
}

}  // namespace armature::viewer
