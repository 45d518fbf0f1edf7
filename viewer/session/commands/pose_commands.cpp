// Deforming a mesh by its spheres.
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <system_error>

#include "viewer/session/command.h"
#include "viewer/session/posing.h"
#include "viewer/session/session.h"
#include "viewer/session/write_text.h"

namespace armature::viewer {
namespace {

using Done = sdk::Expected<void>;

constexpr double kDegrees = 180 / std::numbers::pi;

/// The model that is being posed.
sdk::Expected<Model*> posed(Session& session) {
  auto model = session.active();
  if (model && !(*model)->posing) return sdk::fail("begin with `pose` first");
  return model;
}

Done pose(Session& session, Arguments& arguments) {
  if (auto checked = arguments.check(); !checked) return checked;
  const auto found = session.active_at_rest();
  if (!found) return tl::unexpected(found.error());
  const auto active = session.active_spheres();
  if (!active) return tl::unexpected(active.error());
  if (!(*active)->spheres->hierarchy) return sdk::fail("this sphere-mesh has one level alone; build a hierarchy first");
  session.start("preparing the mesh to be posed",
                [&session, spheres = (*active)->spheres->cursor->size(),
                 model = *found](const sdk::Task& task) -> sdk::Expected<Job::Apply> {
                  auto posing = Posing::begin(model->mesh, model->spheres->hierarchy, spheres, task);
                  if (!posing) return tl::unexpected(posing.error());
                  auto laid = (*posing)->lies();
                  if (!laid) return tl::unexpected(laid.error());
                  return Job::Apply([&session, model, posing = *posing, pose = std::move(*laid)] {
                    model->posing = posing;
                    model->handle.clear();
                    model->lay(pose);
                    session.tool = Tool::Pose;
                    session.panel = Panel::Spheres;
                    session.looks.mesh = MeshLook::Glass;
                    session.looks.spheres = SpheresLook::Structure;
                  });
                });
  return {};
}

Done handle(Session& session, Arguments& arguments) {
  const auto model = posed(session);
  if (!model) return tl::unexpected(model.error());
  std::vector<sdk::SphereId> spheres;
  const std::size_t level = (*model)->pose->shape->spheres.size();
  while (arguments.left() > 0 && spheres.size() <= level) spheres.emplace_back(arguments.count("sphere", 0, level - 1));
  if (auto checked = arguments.check(); !checked) return checked;
  if (auto checked = sdk::check({.spheres = spheres}, level); !checked && !spheres.empty()) return checked;
  (*model)->handle = std::move(spheres);
  return {};
}

/// Moves what the handle holds.
Done moved(Session& session, Arguments& arguments, sdk::SphereMove move) {
  if (auto checked = arguments.check(); !checked) return checked;
  const auto model = posed(session);
  if (!model) return tl::unexpected(model.error());
  if ((*model)->handle.empty()) return sdk::fail("choose a sphere, an edge or a triangle first");
  move.spheres = (*model)->handle;
  if (auto checked = sdk::check(move, (*model)->pose->shape->spheres.size()); !checked) return checked;
  return lay(session, "moving what is held", [move](Posing& posing, const sdk::Task&) { return posing.move(move); });
}

Done translate(Session& session, Arguments& arguments) {
  const Eigen::Vector3d by = arguments.vector("way");
  return moved(session, arguments, {.translate = by});
}

Done rotate(Session& session, Arguments& arguments) {
  const Eigen::Vector3d axis = arguments.vector("axis");
  const double angle = arguments.number("degrees") / kDegrees;
  if (arguments.check() && !(axis.norm() > 0)) return sdk::fail("axis: expected one of some length, found 0 0 0");
  return moved(session, arguments, {.rotate = angle * axis.stableNormalized()});
}

Done scale(Session& session, Arguments& arguments) {
  const double factor = arguments.number("factor", 0.01, 100);
  return moved(session, arguments, {.scale = factor});
}

Done swell(Session& session, Arguments& arguments) {
  const double radius = arguments.number("radius", 0, 1e300);
  return moved(session, arguments, {.radius = radius});
}

template <bool Pinned>
Done pin(Session& session, Arguments& arguments) {
  if (auto checked = arguments.check(); !checked) return checked;
  const auto model = posed(session);
  if (!model) return tl::unexpected(model.error());
  if ((*model)->handle.empty()) return sdk::fail("choose a sphere, an edge or a triangle first");
  return lay(session, Pinned ? "pinning what is held" : "letting it move",
             [held = (*model)->handle](Posing& posing, const sdk::Task&) { return posing.pin(held, Pinned); });
}

Done save_pose(Session& session, Arguments& arguments) {
  const std::string file = arguments.file();
  if (auto checked = arguments.check(); !checked) return checked;
  const auto model = posed(session);
  if (!model) return tl::unexpected(model.error());
  session.start(
      "writing " + file_name(file),
      [&session, file, posing = (*model)->posing](const sdk::Task&) {
        return write_text(file, posing->text()).map([&] {
          return Job::Apply([&session, file] { session.tell("wrote " + file); });
        });
      },
      Stops::Never);
  return {};
}

Done replay_pose(Session& session, Arguments& arguments) {
  const std::string file = arguments.file();
  if (auto checked = arguments.check(); !checked) return checked;
  if (auto model = posed(session); !model) return tl::unexpected(model.error());
  std::error_code none;
  std::ifstream in(file, std::ios::binary);
  if (!in || !std::filesystem::is_regular_file(file, none))
    return sdk::fail(file + ": cannot be read; expected the steps of a deformation");
  std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  return lay(session, "posing as " + file_name(file),
             [file, text](Posing& posing, const sdk::Task& task) { return posing.replay(text, file, task); },
             {.lets_go = true, .stops = Stops::ByItself});
}

Done bake(Session& session, Arguments& arguments) {
  if (auto checked = arguments.check(); !checked) return checked;
  const auto active = posed(session);
  if (!active) return tl::unexpected(active.error());
  session.start(
      "making a mesh of the pose",
      [&session, pose = (*active)->pose, name = (*active)->name](const sdk::Task&) -> sdk::Expected<Job::Apply> {
        auto model = std::make_shared<Model>();
        model->name = name + " posed";
        model->mesh = std::make_shared<const MeshShape>(pose->mesh);
        return Job::Apply([&session, model] {
          const OrbitCamera camera = session.camera;
          session.tool = Tool::Look;
          session.looks.mesh = MeshLook::Solid;
          session.add(model);
          session.camera = camera;
        });
      });
  return {};
}

Done unpose(Session& session, Arguments& arguments) {
  if (auto checked = arguments.check(); !checked) return checked;
  const auto model = posed(session);
  if (!model) return tl::unexpected(model.error());
  session.start(
      "putting the mesh back",
      [&session, model = session.models[session.active_model]](const sdk::Task&) -> sdk::Expected<Job::Apply> {
        const sdk::LevelCursor& cursor = *model->spheres->cursor;
        auto level = std::make_shared<Level>(make_level(cursor, cursor.size()));
        return Job::Apply([&session, model, level] {
          // A factorisation of a large mesh takes a while to go, too.
          session.discard({std::exchange(model->posing, nullptr), std::exchange(model->pose, nullptr)});
          model->previewed.reset();
          model->handle.clear();
          model->go_to(*level);
          session.discard(level);
          ++model->mesh_revision;
          session.tool = Tool::Look;
          session.looks.mesh = MeshLook::Solid;
        });
      });
  return {};
}

constexpr std::array kCommands = {
    Command{"pose", "", "begin to deform the mesh by the spheres of this level", pose},
    Command{"handle", "[SPHERE ...]", "hold these spheres: one, the two of an edge, the three of a triangle", handle},
    Command{"translate", "X Y Z", "move what is held, in the model's unit", translate},
    Command{"rotate", "X Y Z DEGREES", "turn it about its middle, about this axis", rotate},
    Command{"scale", "FACTOR", "make it larger or smaller", scale},
    Command{"swell", "RADIUS", "let its spheres have this radius", swell},
    Command{"pin", "", "what is held stays where it is from now on", pin<true>},
    Command{"unpin", "", "let it move again", pin<false>},
    Command{"save-pose", "FILE", "write the steps of the deformation", save_pose},
    Command{"replay-pose", "FILE", "carry out the steps of such a file", replay_pose},
    Command{"bake", "", "open the posed mesh as a model of its own", bake},
    Command{"unpose", "", "put the mesh back as it was", unpose},
};

}  // namespace

std::span<const Command> pose_commands() {
  return kCommands;
}

}  // namespace armature::viewer
