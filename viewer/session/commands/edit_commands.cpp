// What is like a spot, and edits of all that is.
#include <array>
#include <utility>

#include <armature/sdk/expansion/patch_map.h>

#include "viewer/scene/scene.h"
#include "viewer/scene/shading.h"
#include "viewer/session/command.h"
#include "viewer/session/extent.h"
#include "viewer/session/session.h"

namespace armature::viewer {
namespace {

using Done = sdk::Expected<void>;

/// What patch shape contexts look at around a vertex, of the bounding box's diagonal.
constexpr double kSpot = 0.05;

/// similarity MAP [VERTEX]: to a vertex, or to the region selected last.
Done similarity(Session& session, Arguments& arguments) {
  const auto by = static_cast<Likeness>(arguments.choice("map", kLikenesses));
  const auto found = session.active_unposed();
  if (!found) return tl::unexpected(found.error());
  const std::shared_ptr<Model>& model = *found;
  const sdk::Surface& surface = model->mesh->surface;
  const bool spot = arguments.left() > 0;
  std::vector<sdk::VertexId> vertices;
  if (spot) {
    vertices.emplace_back(arguments.count("vertex", 0, surface.mesh.positions.size() - 1));
  } else {
    vertices = vertices_of(surface.mesh, model->selecting.reference);
  }
  if (auto checked = arguments.check(); !checked) return checked;
  if (vertices.empty()) return sdk::fail("click a spot, or select a region first; the map shows what is like it");
  double radius = kSpot * surface.diagonal;
  if (!spot && by == Likeness::Psc) {
    const auto ball = sdk::patch_ball(surface, model->selecting.reference);
    if (!ball) return tl::unexpected(ball.error());
    radius = ball->radius;
  }
  // Contexts of a region depend on its size: only those of spots are kept.
  const bool keeps = spot || by != Likeness::Psc;
  const auto known = model->editing.descriptors.find(by);
  auto descriptor = keeps && known != model->editing.descriptors.end() ? known->second : nullptr;
  session.start("comparing all vertices",
                [&session, by, model, vertices = std::move(vertices), radius, keeps,
                 descriptor](const sdk::Task& task) mutable -> sdk::Expected<Job::Apply> {
                  if (!descriptor) {
                    auto made = describe(*model->mesh, by, radius, task);
                    if (!made) return tl::unexpected(made.error());
                    descriptor = std::move(*made);
                  }
                  auto alike = similarity_to(*descriptor, vertices, task);
                  if (!alike) return tl::unexpected(alike.error());
                  return Job::Apply([&session, by, model, keeps, descriptor, alike = std::move(*alike)] {
                    if (keeps) model->editing.descriptors[by] = descriptor;
                    model->editing.similarity = alike;
                    session.show_map(*model, MapKind::Compared, alike);
                  });
                });
  return {};
}

Done transfer(Session& session, Arguments& arguments) {
  const double from = arguments.number("from", 0, 1), to = arguments.number("to", 0, 1);
  if (auto checked = arguments.check(); !checked) return checked;
  if (!(to > from)) return sdk::fail("to: expected more than where it begins");
  const auto model = session.active_unposed();
  if (!model) return tl::unexpected(model.error());
  (*model)->editing.transfer = {from, to};
  return {};
}

/// edit OP AMOUNT map|regions: shown instead of the mesh until it is kept or dropped.
Done edit(Session& session, Arguments& arguments) {
  Edit what;
  what.op = static_cast<EditOp>(arguments.choice("op", kEditOps));
  what.amount = arguments.number("amount", -1e3, 1e3);
  what.regions = arguments.choice("where", {"map", "regions"}) == 1;
  if (auto checked = arguments.check(); !checked) return checked;
  const auto found = session.active_unposed();
  if (!found) return tl::unexpected(found.error());
  const Selecting& selecting = (*found)->selecting;
  EditPlaces places{.similarity = (*found)->editing.similarity,
                    .transfer = (*found)->editing.transfer,
                    .reference = selecting.reference};
  if (selecting.expansion) {
    const auto shown = selecting.expansion->first(selecting.shown);
    places.matches.assign(shown.begin(), shown.end());
  }
  session.start(
      "editing",
      [&session, what, places = std::move(places), model = *found](const sdk::Task& task) -> sdk::Expected<Job::Apply> {
        auto mesh = edited(*model->mesh, what, places, task);
        if (!mesh) return tl::unexpected(mesh.error());
        auto normals = corner_normals(*mesh, MeshStyle().crease_rad);
        const sdk::Sphere around = sphere_around(*mesh);
        auto tried = std::make_shared<const ShadedMesh>(ShadedMesh{std::move(*mesh), std::move(normals), around, what});
        return Job::Apply([&session, what, model, tried] {
          session.discard(std::exchange(model->editing.tried, tried));
          ++model->mesh_revision;
          if (what.op == EditOp::Paint) session.looks.map = MapKind::None;
          if (session.looks.mesh == MeshLook::Off) session.looks.mesh = MeshLook::Solid;
        });
      });
  return {};
}

/// The model gets another mesh of the same faces: what was found on the old one goes, what is selected stays, and so
/// does what was compared.
void change_mesh(Session& session, Model& model, std::shared_ptr<const MeshShape> mesh) {
  session.discard(
      {std::exchange(model.mesh, std::move(mesh)), std::exchange(model.editing.tried, nullptr), model.take_spheres(),
       std::make_shared<decltype(model.editing.descriptors)>(std::exchange(model.editing.descriptors, {}))});
  Selecting selected;
  selected.selection = std::move(model.selecting.selection);
  selected.pieces = model.selecting.pieces;
  model.selecting = std::move(selected);
  ++model.mesh_revision;
  if (session.looks.mesh == MeshLook::Off) session.looks.mesh = MeshLook::Solid;  // there are no spheres now
  if (session.looks.map != MapKind::Components && session.looks.map != MapKind::Compared) {
    session.looks.map = MapKind::None;
    model.values.clear();
  }
  ++model.colour_revision;
}

Done keep_edit(Session& session, Arguments& arguments) {
  if (auto checked = arguments.check(); !checked) return checked;
  const auto found = session.active_unposed();
  if (!found) return tl::unexpected(found.error());
  if (!(*found)->editing.tried) return sdk::fail("there is no edit to keep; try one first");
  session.start("keeping the edit", [&session, model = *found](const sdk::Task&) -> sdk::Expected<Job::Apply> {
    auto mesh = std::make_shared<const MeshShape>(model->editing.tried->mesh);
    return Job::Apply([&session, model, mesh] {
      model->editing.before.push_back({model->mesh, model->take_spheres()});
      change_mesh(session, *model, mesh);
    });
  });
  return {};
}

Done drop_edit(Session& session, Arguments& arguments) {
  if (auto checked = arguments.check(); !checked) return checked;
  const auto found = session.active_unposed();
  if (!found) return tl::unexpected(found.error());
  session.discard(std::exchange((*found)->editing.tried, nullptr));
  ++(*found)->mesh_revision;
  return {};
}

Done undo_edit(Session& session, Arguments& arguments) {
  if (auto checked = arguments.check(); !checked) return checked;
  const auto found = session.active_unposed();
  if (!found) return tl::unexpected(found.error());
  auto& before = (*found)->editing.before;
  if (before.empty()) return sdk::fail("no edit was kept yet");
  Editing::Replaced replaced = std::move(before.back());
  before.pop_back();
  change_mesh(session, **found, std::move(replaced.mesh));
  (*found)->put_spheres(std::move(replaced.spheres));
  return {};
}

constexpr std::array kCommands = {
    Command{"similarity", "gls|hks|wks|psc [VERTEX]", "colour what is like a vertex, or like the region selected last",
            similarity},
    Command{"transfer", "FROM TO", "edits begin at so much similarity, and are full from there on", transfer, true},
    Command{"edit", "displace|smooth|sharpen|paint|pull|copy|alike AMOUNT map|regions",
            "try an edit by the similarity, or of the region and the matches shown; lengths as parts of the diagonal",
            edit},
    Command{"keep-edit", "", "make the edit that is shown the mesh", keep_edit},
    Command{"drop-edit", "", "show the mesh without it again", drop_edit},
    Command{"undo-edit", "", "take back the edit that was kept last", undo_edit},
};

}  // namespace

std::span<const Command> edit_commands() {
  return kCommands;
}

}  // namespace armature::viewer
