// Regions of a mesh: selected by a gesture, and all that is like them.
#include <algorithm>
#include <array>

#include <armature/sdk/expansion/expand_part.h>
#include <armature/sdk/expansion/patch_expansion.h>
#include <armature/sdk/selection/boundary.h>
#include <armature/sdk/selection/lasso.h>

#include "viewer/session/command.h"
#include "viewer/session/posing.h"
#include "viewer/session/session.h"

namespace armature::viewer {
namespace {

using Done = sdk::Expected<void>;
using Faces = std::vector<sdk::FaceId>;

/// Matches that are as good as sure are shown at once.
constexpr double kClear = 0.85;

/// What follows from another selection.
void selection_changed(Model& model) {
  model.selecting.pieces = sdk::count_pieces(model.mesh->surface.adjacency, model.selecting.selection.faces());
  ++model.colour_revision;
}

void forget_matches(Selecting& selecting) {
  selecting.expansion.reset();
  selecting.shown = 0;
  selecting.more_shown.clear();
}

/// What a gesture selected joins the selection, and becomes what others are compared with. `again`: it refines the last
/// gesture, in place of which it counts.
void take_reference(sdk::Combine how, Model& model, Selecting::Kind kind, Faces faces, bool again) {
  Selecting& selecting = model.selecting;
  if (again) selecting.selection.undo();
  selecting.selection.combine(faces, how);
  selecting.kind = kind;
  selecting.reference = std::move(faces);
  forget_matches(selecting);
  selecting.drawn.clear();
  selection_changed(model);
}

void forget_reference(Model& model) {
  model.selecting.kind = Selecting::Kind::None;
  model.selecting.reference.clear();
  forget_matches(model.selecting);
  selection_changed(model);
}

Done click(Session& session, Arguments& arguments) {
  const auto model = session.active_unposed();
  if (!model) return tl::unexpected(model.error());
  const sdk::FaceId face(arguments.count("face", 0, (*model)->mesh->mesh.triangles.size() - 1));
  if (auto checked = arguments.check(); !checked) return checked;
  session.start("finding components",
                [how = session.combine, face,
                 model = session.models[session.active_model]](const sdk::Task& task) -> sdk::Expected<Job::Apply> {
                  const auto index = model->mesh->components(task);
                  if (!index) return tl::unexpected(index.error());
                  auto faces = (*index)->select(face);
                  if (!faces) return tl::unexpected(faces.error());
                  return Job::Apply([how, model, faces = std::move(*faces)] {
                    take_reference(how, *model, Selecting::Kind::Component, faces, false);
                  });
                });
  return {};
}

Done cut(Session& session, Arguments& arguments) {
  const auto active = session.active_unposed();
  if (!active) return tl::unexpected(active.error());
  const bool again = arguments.choice("cut", {"new", "add"}) == 1;
  auto stroke = arguments.points("stroke", 3, 1);
  if (auto checked = arguments.check(); !checked) return checked;
  if (again && ((*active)->selecting.kind != Selecting::Kind::Part || !(*active)->selecting.cut))
    return sdk::fail("there is no cut to go on with; draw a new one");
  session.start("cutting",
                [how = session.combine, again, stroke = std::move(stroke),
                 model = session.models[session.active_model]](const sdk::Task& task) -> sdk::Expected<Job::Apply> {
                  const auto parts = model->mesh->parts(task);
                  if (!parts) return tl::unexpected(parts.error());
                  const auto points = sdk::project_stroke(model->mesh->surface, stroke, "the stroke");
                  if (!points) return tl::unexpected(points.error());
                  auto cut = again ? std::make_shared<sdk::PartCut>(*model->selecting.cut)
                                   : std::make_shared<sdk::PartCut>(**parts);
                  cut->begin_stroke();
                  for (const sdk::SurfacePoint& point : *points) cut->add_point(point);
                  auto faces = cut->faces();
                  if (!faces) return tl::unexpected(faces.error());
                  return Job::Apply([how, model, again, parts = *parts, cut, faces = std::move(*faces)] {
                    model->selecting.parts = parts;
                    model->selecting.cut = cut;
                    take_reference(how, *model, Selecting::Kind::Part, faces, again);
                  });
                });
  return {};
}

Done other_side(Session& session, Arguments& arguments) {
  if (auto checked = arguments.check(); !checked) return checked;
  const auto active = session.active_mesh();
  if (!active) return tl::unexpected(active.error());
  const Selecting& selecting = (*active)->selecting;
  if (selecting.kind != Selecting::Kind::Part || !selecting.cut) return sdk::fail("draw along a cut first");
  session.start("taking the other side",
                [how = session.combine,
                 model = session.models[session.active_model]](const sdk::Task&) -> sdk::Expected<Job::Apply> {
                  auto cut = std::make_shared<sdk::PartCut>(*model->selecting.cut);
                  cut->swap_sides();
                  auto faces = cut->faces();
                  if (!faces) return tl::unexpected(faces.error());
                  return Job::Apply([how, model, cut, faces = std::move(*faces)] {
                    model->selecting.cut = cut;
                    take_reference(how, *model, Selecting::Kind::Part, faces, true);
                  });
                });
  return {};
}

Done brush(Session& session, Arguments& arguments) {
  const auto active = session.active_unposed();
  if (!active) return tl::unexpected(active.error());
  const std::size_t how = arguments.choice("brush", {"new", "add", "background"});
  const double radius = arguments.number("radius", 1e-300, 1e300);
  const auto stroke = arguments.points("stroke", 3, 1);
  if (auto checked = arguments.check(); !checked) return checked;
  const Selecting& selecting = (*active)->selecting;
  const bool again = how != 0;
  if (again && selecting.kind != Selecting::Kind::Patch)
    return sdk::fail("there is no patch to go on with; brush over one");
  sdk::PatchStrokes drawn = again ? selecting.strokes : sdk::PatchStrokes{};
  drawn.radius = radius;
  (how == 2 ? drawn.background : drawn.strokes).push_back(stroke);
  session.start("brushing",
                [how = session.combine, again, drawn = std::move(drawn),
                 model = session.models[session.active_model]](const sdk::Task&) -> sdk::Expected<Job::Apply> {
                  auto faces = sdk::select_patch(model->mesh->surface, drawn);
                  if (!faces) return tl::unexpected(faces.error());
                  return Job::Apply([how, again, drawn, model, faces = std::move(*faces)] {
                    model->selecting.strokes = drawn;
                    take_reference(how, *model, Selecting::Kind::Patch, faces, again);
                  });
                });
  return {};
}

Done lasso(Session& session, Arguments& arguments) {
  const auto active = session.active_unposed();
  if (!active) return tl::unexpected(active.error());
  const auto polygon = arguments.points("lasso", 2, 3);
  if (auto checked = arguments.check(); !checked) return checked;
  sdk::Lasso drawn{.loop = {}, .seen_from = sdk::Eye{session.camera.eye()}};
  for (const Eigen::Vector3d& at : polygon) {
    const sdk::Ray ray = session.camera.ray(at.head<2>());
    drawn.loop.emplace_back(ray.origin + session.camera.distance * ray.direction);
  }
  session.start("selecting what the lasso holds",
                [how = session.combine, drawn = std::move(drawn),
                 model = session.models[session.active_model]](const sdk::Task&) -> sdk::Expected<Job::Apply> {
                  auto faces = sdk::select_lasso(model->mesh->surface, drawn);
                  if (!faces) return tl::unexpected(faces.error());
                  return Job::Apply([how, model, faces = std::move(*faces)] {
                    take_reference(how, *model, Selecting::Kind::Lasso, faces, false);
                  });
                });
  return {};
}

/// Lets the boundary of the last region run where the surface is best cut nearby.
Done snap(Session& session, Arguments& arguments) {
  const auto active = session.active_mesh();
  if (!active) return tl::unexpected(active.error());
  const double width = arguments.left() > 0 ? arguments.number("width", 1e-4, 0.5) : 0.02;
  if (auto checked = arguments.check(); !checked) return checked;
  if ((*active)->selecting.reference.empty()) return sdk::fail("select a region first: by click, cut, brush or lasso");
  session.start("looking for the best boundary",
                [how = session.combine, width,
                 model = session.models[session.active_model]](const sdk::Task& task) -> sdk::Expected<Job::Apply> {
                  auto faces = sdk::snap_boundary(model->mesh->surface, model->selecting.reference,
                                                  width * model->mesh->surface.diagonal, task);
                  if (!faces) return tl::unexpected(faces.error());
                  return Job::Apply([how, model, faces = std::move(*faces)] {
                    take_reference(how, *model, model->selecting.kind, faces, true);
                  });
                });
  return {};
}

/// drag-edge FROM TO [SNAP]: lets the boundary of the last region run through another point.
Done drag_edge(Session& session, Arguments& arguments) {
  const auto active = session.active_unposed();
  if (!active) return tl::unexpected(active.error());
  const sdk::Surface& surface = (*active)->mesh->surface;
  const Eigen::Vector3d from = arguments.vector("from"), to = arguments.vector("to");
  const double snap = arguments.left() > 0 ? arguments.number("snap", 0, 0.5) : 0;
  if (auto checked = arguments.check(); !checked) return checked;
  const auto ends = sdk::project_stroke(surface, {from, to}, "the drag");
  if (!ends) return tl::unexpected(ends.error());
  if ((*active)->selecting.reference.empty()) return sdk::fail("select a region first: by click, cut, brush or lasso");
  session.start("moving the boundary",
                [how = session.combine, drag = boundary_drag(surface, ends->front(), ends->back(), snap),
                 model = session.models[session.active_model]](const sdk::Task& task) -> sdk::Expected<Job::Apply> {
                  auto faces = sdk::drag_boundary(model->mesh->surface, model->selecting.reference, drag, task);
                  if (!faces) return tl::unexpected(faces.error());
                  return Job::Apply([how, model, faces = std::move(*faces)] {
                    take_reference(how, *model, model->selecting.kind, faces, true);
                  });
                });
  return {};
}

sdk::Expected<sdk::Expansion> expanded(const Model& model, const sdk::Task& task) {
  const Selecting& selecting = model.selecting;
  switch (selecting.kind) {
    case Selecting::Kind::Component: {
      const auto index = model.mesh->components(task);
      if (!index) return tl::unexpected(index.error());
      return (*index)->expand(selecting.reference.front());
    }
    case Selecting::Kind::Part: return sdk::expand_part(*selecting.parts, selecting.reference, {}, task);
    case Selecting::Kind::Patch:
    case Selecting::Kind::Lasso: return sdk::expand_patch(model.mesh->surface, selecting.reference, {}, task);
    case Selecting::Kind::None: break;
  }
  return sdk::fail("select a region first");
}

Done expand(Session& session, Arguments& arguments) {
  if (auto checked = arguments.check(); !checked) return checked;
  const auto active = session.active_mesh();
  if (!active) return tl::unexpected(active.error());
  if ((*active)->selecting.reference.empty()) return sdk::fail("select a region first: by click, cut, brush or lasso");
  session.start(
      "looking for what is like it",
      [model = session.models[session.active_model]](const sdk::Task& task) -> sdk::Expected<Job::Apply> {
        auto expansion = expanded(*model, task);
        if (!expansion) return tl::unexpected(expansion.error());
        return Job::Apply([model, expansion = std::move(*expansion)] {
          forget_matches(model->selecting);
          const auto all = expansion.first(expansion.size());
          model->selecting.shown = static_cast<std::size_t>(
              std::ranges::find_if(all, [](const sdk::Match& match) { return match.score < kClear; }) - all.begin());
          model->selecting.expansion = expansion;
          ++model->colour_revision;
        });
      });
  return {};
}

/// The model's expansion, for the commands about it.
sdk::Expected<Model*> with_expansion(Session& session) {
  auto model = session.active_mesh();
  if (model && !(*model)->selecting.expansion) return sdk::fail("look for what is like the selection first");
  return model;
}

Done matches(Session& session, Arguments& arguments) {
  const auto model = with_expansion(session);
  if (!model) return tl::unexpected(model.error());
  const std::size_t shown = arguments.count("matches", 0, (*model)->selecting.expansion->size());
  if (auto checked = arguments.check(); !checked) return checked;
  (*model)->selecting.shown = shown;
  ++(*model)->colour_revision;
  return {};
}

Done accept(Session& session, Arguments& arguments) {
  const auto model = with_expansion(session);
  if (!model) return tl::unexpected(model.error());
  Selecting& selecting = (*model)->selecting;
  const std::size_t place = arguments.count("match", 1, selecting.expansion->size());
  if (auto checked = arguments.check(); !checked) return checked;
  selecting.expansion->accept(place - 1);
  selecting.more_shown.push_back(selecting.shown == 0 ? 1 : 0);
  selecting.shown = std::max<std::size_t>(selecting.shown, 1);
  ++(*model)->colour_revision;
  return {};
}

Done reject(Session& session, Arguments& arguments) {
  const auto model = with_expansion(session);
  if (!model) return tl::unexpected(model.error());
  Selecting& selecting = (*model)->selecting;
  const std::size_t place = arguments.count("match", 1, selecting.expansion->size());
  if (auto checked = arguments.check(); !checked) return checked;
  selecting.expansion->reject(place - 1);
  selecting.more_shown.push_back(place <= selecting.shown ? -1 : 0);
  if (place <= selecting.shown) --selecting.shown;
  ++(*model)->colour_revision;
  return {};
}

Done reconsider(Session& session, Arguments& arguments) {
  if (auto checked = arguments.check(); !checked) return checked;
  const auto model = with_expansion(session);
  if (!model) return tl::unexpected(model.error());
  Selecting& selecting = (*model)->selecting;
  if (!selecting.expansion->undo()) return sdk::fail("nothing was accepted or rejected yet");
  const auto before = static_cast<std::ptrdiff_t>(selecting.shown) - selecting.more_shown.back();
  selecting.shown = static_cast<std::size_t>(
      std::clamp(before, std::ptrdiff_t{0}, static_cast<std::ptrdiff_t>(selecting.expansion->size())));
  selecting.more_shown.pop_back();
  ++(*model)->colour_revision;
  return {};
}

Done take(Session& session, Arguments& arguments) {
  if (auto checked = arguments.check(); !checked) return checked;
  const auto model = with_expansion(session);
  if (!model) return tl::unexpected(model.error());
  Selecting& selecting = (*model)->selecting;
  Faces faces = selecting.reference;
  for (const sdk::Match& match : selecting.expansion->first(selecting.shown))
    faces.insert(faces.end(), match.faces.begin(), match.faces.end());
  selecting.selection.combine(std::move(faces), sdk::Combine::Add);
  forget_reference(**model);
  return {};
}

Done clear(Session& session, Arguments& arguments) {
  if (auto checked = arguments.check(); !checked) return checked;
  const auto model = session.active_mesh();
  if (!model) return tl::unexpected(model.error());
  (*model)->selecting.selection.combine({}, sdk::Combine::Replace);
  forget_reference(**model);
  return {};
}

/// Of how a posed model lies, but where regions are selected; else of the selection.
Done step(Session& session, Arguments& arguments, bool (sdk::Selection::*of_selecting)(),
          Posing::Laid (Posing::*of_posing)(), const char* nothing_left) {
  if (auto checked = arguments.check(); !checked) return checked;
  const auto model = session.active_mesh();
  if (!model) return tl::unexpected(model.error());
  if ((*model)->posing && session.panel != Panel::Select)
    return lay(session, "taking a step back or forward",
               [of_posing](Posing& posing, const sdk::Task&) { return (posing.*of_posing)(); }, {.lets_go = true});
  if (!((*model)->selecting.selection.*of_selecting)()) return sdk::fail(nothing_left);
  forget_reference(**model);
  return {};
}

Done undo(Session& session, Arguments& arguments) {
  return step(session, arguments, &sdk::Selection::undo, &Posing::undo, kNothingToUndo);
}

Done redo(Session& session, Arguments& arguments) {
  return step(session, arguments, &sdk::Selection::redo, &Posing::redo, kNothingToRedo);
}

Done combine(Session& session, Arguments& arguments) {
  const std::size_t how = arguments.choice("combine", kCombines);
  if (auto checked = arguments.check(); !checked) return checked;
  session.combine = static_cast<sdk::Combine>(how);
  return {};
}

Done brush_size(Session& session, Arguments& arguments) {
  const double size = arguments.number("size", 0.002, 0.5);
  if (auto checked = arguments.check(); !checked) return checked;
  session.brush = size;
  return {};
}

constexpr std::array kCommands = {
    Command{"click", "FACE", "select the connected component of a face", click},
    Command{"cut", "new|add X Y Z ...", "select what a stroke along a cut cuts off, or draw on at the same cut", cut},
    Command{"other-side", "", "select the other side of the cut", other_side},
    Command{"brush", "new|add|background RADIUS X Y Z ...", "select the patch under a brush", brush},
    Command{"lasso", "X Y ...", "select the faces that are seen within a loop in the view", lasso},
    Command{"snap", "[WIDTH]", "let the boundary run where the surface is best cut nearby", snap},
    Command{"drag-edge", "X Y Z X Y Z [SNAP]", "let the boundary run from there through here instead", drag_edge},
    Command{"combine", "replace|add|subtract|intersect", "what a gesture does to the selection", combine, true},
    Command{"brush-size", "SIZE", "the brush's radius, as a part of the model's size", brush_size, true},
    Command{"expand", "", "look for regions like the one selected last", expand},
    Command{"matches", "K", "show the K best of them", matches},
    Command{"accept", "N", "the N-th match is right: what is like it rises", accept},
    Command{"reject", "N", "the N-th match is wrong: it goes, and what is like it falls", reject},
    Command{"reconsider", "", "take back the last accept or reject", reconsider},
    Command{"take", "", "select the matches that are shown", take},
    Command{"clear", "", "select nothing", clear},
    Command{"undo", "", "take back the last step of posing, or, without a pose and on panel select, of selecting",
            undo},
    Command{"redo", "", "do it again", redo},
};

}  // namespace

std::span<const Command> select_commands() {
  return kCommands;
}

}  // namespace armature::viewer
