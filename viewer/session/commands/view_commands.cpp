// The camera and how things look.
#include <array>
#include <numbers>

#include <armature/sdk/mesh/components.h>
#include <armature/sdk/mesh/curvature.h>

#include "viewer/session/command.h"
#include "viewer/session/maps.h"
#include "viewer/session/session.h"

namespace armature::viewer {
namespace {

using Done = sdk::Expected<void>;

constexpr double kDegrees = 180 / std::numbers::pi;

Done camera(Session& session, Arguments& arguments) {
  OrbitCamera camera = session.camera;
  camera.view.azimuth_rad = arguments.number("azimuth in degrees", -360, 360) / kDegrees;
  camera.view.elevation_rad = arguments.number("elevation in degrees", -89, 89) / kDegrees;
  if (arguments.left() > 0) {
    camera.distance = arguments.number("distance", 1e-12, 1e12);
    camera.target = arguments.vector("target");
  }
  if (auto checked = arguments.check(); !checked) return checked;
  session.camera = camera;
  return {};
}

Done fit(Session& session, Arguments& arguments) {
  if (auto checked = arguments.check(); !checked) return checked;
  session.see_all();
  return {};
}

Done up(Session& session, Arguments& arguments) {
  const std::size_t choice = arguments.choice("up", {"x", "y", "z", "-x", "-y", "-z"});
  if (auto checked = arguments.check(); !checked) return checked;
  session.camera.view.up = static_cast<Up>(choice);
  return {};
}

/// A command that sets one of a few values.
template <auto Member>
Done choose(Session& session, Arguments& arguments, std::string_view what,
            const std::vector<std::string_view>& choices) {
  const std::size_t choice = arguments.choice(what, choices);
  if (auto checked = arguments.check(); !checked) return checked;
  auto& member = session.*Member;
  member = static_cast<std::remove_reference_t<decltype(member)>>(choice);
  return {};
}

Done mode(Session& session, Arguments& arguments) {
  return choose<&Session::mode>(session, arguments, "mode", kModes);
}

/// Tools go with the panel that has them.
Done panel(Session& session, Arguments& arguments) {
  const Panel before = session.panel;
  auto done = choose<&Session::panel>(session, arguments, "panel", kPanels);
  if (done && session.panel != before) session.tool = Tool::Look;
  return done;
}

Done tool(Session& session, Arguments& arguments) {
  if (auto done = choose<&Session::tool>(session, arguments, "tool", kTools); !done) return done;
  switch (session.tool) {
    case Tool::Look: break;
    case Tool::Pose: session.panel = Panel::Spheres; break;
    case Tool::Spot: session.panel = Panel::Edit; break;
    case Tool::Click:
    case Tool::Cut:
    case Tool::Brush:
    case Tool::Lasso:
    case Tool::Edge: session.panel = Panel::Select; break;
  }
  return {};
}

Done mesh(Session& session, Arguments& arguments) {
  const std::size_t choice = arguments.choice("mesh", kMeshLooks);
  if (auto checked = arguments.check(); !checked) return checked;
  session.looks.mesh = static_cast<MeshLook>(choice);
  return {};
}

Done spheres(Session& session, Arguments& arguments) {
  const std::size_t choice = arguments.choice("spheres", kSpheresLooks);
  if (auto checked = arguments.check(); !checked) return checked;
  session.looks.spheres = static_cast<SpheresLook>(choice);
  return {};
}

Done wireframe(Session& session, Arguments& arguments) {
  const bool on = arguments.on_off("wireframe");
  if (auto checked = arguments.check(); !checked) return checked;
  session.looks.wireframe = on;
  return {};
}

Done matcap(Session& session, Arguments& arguments) {
  const bool on = arguments.on_off("matcap");
  if (auto checked = arguments.check(); !checked) return checked;
  session.looks.matcap = on;
  return {};
}

Done map(Session& session, Arguments& arguments) {
  const auto kind = static_cast<MapKind>(arguments.choice("map", kMaps));
  if (auto checked = arguments.check(); !checked) return checked;
  const auto model = session.active_mesh();
  if (!model) return tl::unexpected(model.error());
  if (kind == MapKind::None || kind == MapKind::Components) {
    session.show_map(**model, kind, {});
    return {};
  }
  if (kind == MapKind::Compared) {
    if ((*model)->editing.similarity.empty()) return sdk::fail("nothing was compared yet; `similarity` does");
    session.show_map(**model, kind, (*model)->editing.similarity);
    return {};
  }
  if (kind == MapKind::Similarity && (*model)->selecting.reference.empty())
    return sdk::fail("select a region first; the map shows what is like it");
  session.start("computing the map",
                [&session, kind, model = session.models[session.active_model],
                 reference = (*model)->selecting.reference](const sdk::Task& task) -> sdk::Expected<Job::Apply> {
                  auto values = compute_map(*model->mesh, kind, reference, task);
                  if (!values) return tl::unexpected(values.error());
                  return Job::Apply(
                      [&session, kind, model, values = std::move(*values)] { session.show_map(*model, kind, values); });
                });
  return {};
}

Done pick(Session& session, Arguments& arguments) {
  const double x = arguments.number("x");
  const double y = arguments.number("y");
  if (auto checked = arguments.check(); !checked) return checked;
  session.picked = session.pick({x, y});
  return {};
}

constexpr std::array kCommands = {
    Command{"mode", "shapes|walk", "look at shapes, or walk through the city", mode, true},
    Command{"panel", "look|spheres|select|edit", "which panel is shown beside the shapes", panel, true},
    Command{"tool", "look|click|cut|brush|lasso|edge|pose|spot",
            "what the mouse does; holding Alt it always moves the camera", tool, true},
    Command{"camera", "AZIMUTH ELEVATION [DISTANCE X Y Z]", "degrees; and the point it turns about", camera, true},
    Command{"fit", "", "see all of the model", fit, true},
    Command{"up", "x|y|z|-x|-y|-z", "which direction of the model is up", up, true},
    Command{"mesh", "solid|glass|off", "how the mesh is shown", mesh, true},
    Command{"spheres", "surface|structure|off", "how the sphere-mesh is shown", spheres, true},
    Command{"wireframe", "on|off", "the mesh's edges, over its faces", wireframe, true},
    Command{"matcap", "on|off", "light by the normal alone, without darker corners", matcap, true},
    Command{"map", "none|curvature|protrusion|similarity|components|compared", "colours on the mesh", map},
    Command{"pick", "X Y", "what is there; y is 1 at the view's upper edge, -1 at its lower, x in the same unit", pick,
            true},
};

}  // namespace

std::span<const Command> view_commands() {
  return kCommands;
}

}  // namespace armature::viewer
