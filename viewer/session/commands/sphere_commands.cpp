// Sphere-meshes: hierarchies, levels, refinement, extraction.
#include <algorithm>
#include <array>

#include <armature/sdk/decimation/similar_decimation.h>
#include <armature/sdk/hierarchy/build.h>
#include <armature/sdk/spheremesh/extract.h>
#include <armature/sdk/spheremesh/refine.h>

#include "viewer/session/command.h"
#include "viewer/session/posing.h"
#include "viewer/session/session.h"

namespace armature::viewer {
namespace {

using Done = sdk::Expected<void>;

/// Levels of fewer spheres are reached and drawn in no time.
constexpr std::size_t kLiveSpheres = 10'000;

Done build(Session& session, Arguments& arguments) {
  const double importance = arguments.left() > 0 ? arguments.number("importance", 0, 10) : 0;
  if (auto checked = arguments.check(); !checked) return checked;
  const auto found = session.active_at_rest();
  if (!found) return tl::unexpected(found.error());
  session.start("building the hierarchy",
                [&session, importance, model = *found](const sdk::Task& task) -> sdk::Expected<Job::Apply> {
                  auto built = sdk::build_hierarchy(model->mesh->mesh, {.importance = importance}, task);
                  if (!built) return tl::unexpected(built.error());
                  auto hierarchy = std::make_shared<const sdk::Hierarchy>(std::move(built->hierarchy));
                  return Job::Apply([&session, model, hierarchy] {
                    session.discard(model->take_spheres());
                    model->set_hierarchy(hierarchy, kFirstLevel);
                    session.looks.spheres = SpheresLook::Surface;
                    session.looks.mesh = MeshLook::Off;
                  });
                });
  return {};
}

/// The hierarchy of collapses that are done together where regions are alike, as a model beside the plain one.
Done build_alike(Session& session, Arguments& arguments) {
  const double threshold = arguments.left() > 0 ? arguments.number("threshold", 0, 1) : 0.5;
  if (auto checked = arguments.check(); !checked) return checked;
  const auto found = session.active_at_rest();
  if (!found) return tl::unexpected(found.error());
  session.start("building the hierarchy of what is alike",
                [&session, threshold, plain = *found](const sdk::Task& task) -> sdk::Expected<Job::Apply> {
                  auto alike = sdk::build_similar_hierarchy(plain->mesh->mesh, {}, {.threshold = threshold}, task);
                  if (!alike) return tl::unexpected(alike.error());
                  auto hierarchy = std::make_shared<const sdk::Hierarchy>(std::move(alike->build.hierarchy));
                  std::shared_ptr<const sdk::Hierarchy> beside = plain->spheres ? plain->spheres->hierarchy : nullptr;
                  const bool has_one = beside != nullptr;
                  if (!has_one) {
                    auto built = sdk::build_hierarchy(plain->mesh->mesh, {}, task);
                    if (!built) return tl::unexpected(built.error());
                    beside = std::make_shared<const sdk::Hierarchy>(std::move(built->hierarchy));
                  }
                  return Job::Apply([&session, plain, hierarchy, beside, has_one] {
                    if (!has_one) plain->set_hierarchy(beside, kFirstLevel);
                    const std::size_t place = session.active_model;
                    auto model = std::make_shared<Model>();
                    model->name = plain->name + ", like regions together";
                    model->mesh = plain->mesh;
                    model->set_hierarchy(hierarchy, plain->spheres->shape->spheres.size());
                    session.add(model);
                    session.beside = place + 1;
                    session.see_all();
                    session.looks.spheres = SpheresLook::Surface;
                    session.looks.mesh = MeshLook::Off;
                  });
                });
  return {};
}

Done level(Session& session, Arguments& arguments) {
  const auto model = session.active_spheres();
  if (!model) return tl::unexpected(model.error());
  if (!(*model)->spheres->hierarchy)
    return sdk::fail("this sphere-mesh has one level alone; build the hierarchy of a mesh to have all");
  const sdk::Hierarchy& hierarchy = *(*model)->spheres->hierarchy;
  const std::size_t spheres = arguments.count("spheres", hierarchy.min_spheres(), hierarchy.leaf_count());
  if (auto checked = arguments.check(); !checked) return checked;
  if ((*model)->posing)
    return lay(session, kLevelTitle, [spheres](Posing& posing, const sdk::Task&) { return posing.go_to(spheres); },
               {.lets_go = true});
  std::vector<std::shared_ptr<Model>> slides = {session.models[session.active_model]};
  if (Model* other = session.other(); other != nullptr && other->spheres && other->spheres->hierarchy && !other->posing)
    slides.push_back(session.models[session.beside - 1]);
  const auto level_in = [spheres](const Model& of) {
    return std::clamp(spheres, of.spheres->hierarchy->min_spheres(), of.spheres->hierarchy->leaf_count());
  };
  if (std::max(spheres, (*model)->spheres->cursor->size()) <= kLiveSpheres) {
    for (const auto& slid : slides) slid->go_to(level_in(*slid));
    return {};
  }
  session.start(kLevelTitle, [&session, slides, level_in](const sdk::Task& task) -> sdk::Expected<Job::Apply> {
    auto levels = std::make_shared<std::vector<Level>>();
    for (const auto& slid : slides) {
      levels->push_back(make_level(*slid->spheres->cursor, level_in(*slid)));
      if (task.stopped()) return tl::unexpected(sdk::cancelled().value());
    }
    return Job::Apply([&session, slides, levels] {
      for (std::size_t i = 0; i < slides.size(); ++i) slides[i]->go_to((*levels)[i]);
      session.discard(levels);
    });
  });
  return {};
}

Done refine(Session& session, Arguments& arguments) {
  if (auto checked = arguments.check(); !checked) return checked;
  const auto found = session.active_at_rest();
  if (!found) return tl::unexpected(found.error());
  if (const auto active = session.active_spheres(); !active) return tl::unexpected(active.error());
  session.start("refining the sphere-mesh",
                [model = *found, shape = (*found)->spheres->shape](const sdk::Task& task) -> sdk::Expected<Job::Apply> {
                  auto refined = sdk::refine(model->mesh->mesh, *shape, {}, task);
                  if (!refined) return tl::unexpected(refined.error());
                  return Job::Apply([model, refined = std::make_shared<const sdk::SphereMesh>(std::move(*refined))] {
                    model->set_refined(refined);
                  });
                });
  return {};
}

Done extract(Session& session, Arguments& arguments) {
  const double tolerance = arguments.left() > 0 ? arguments.number("tolerance", 1e-5, 0.1) : 2e-3;
  if (auto checked = arguments.check(); !checked) return checked;
  const auto active = session.active_spheres();
  if (!active) return tl::unexpected(active.error());
  session.start("making a mesh of the sphere-mesh",
                [&session, tolerance, shape = (*active)->spheres->shape,
                 name = (*active)->name](const sdk::Task& task) -> sdk::Expected<Job::Apply> {
                  auto mesh = sdk::extract_surface(*shape, {.tolerance = tolerance}, task);
                  if (!mesh) return tl::unexpected(mesh.error());
                  auto model = std::make_shared<Model>();
                  model->name = name + " extracted";
                  model->mesh = std::make_shared<const MeshShape>(std::move(*mesh));
                  return Job::Apply([&session, model] {
                    const OrbitCamera camera = session.camera;
                    session.add(model);
                    session.camera = camera;  // the same shape, seen from the same place
                    session.looks.mesh = MeshLook::Solid;
                  });
                });
  return {};
}

constexpr std::array kCommands = {
    Command{"build", "[IMPORTANCE]", "the hierarchy of sphere-meshes of the mesh; importance of curved places, 0 to 10",
            build},
    Command{"build-alike", "[THRESHOLD]",
            "the hierarchy that joins like regions together, beside the plain one; how unlike they may be, 0 to 1",
            build_alike},
    Command{"level", "SPHERES", "the level of the hierarchy with so many spheres", level},
    Command{"refine", "", "fit the spheres of this level closer to the mesh", refine},
    Command{"extract", "[TOLERANCE]", "a mesh of the sphere-mesh; tolerance as a part of its size", extract},
};

}  // namespace

std::span<const Command> sphere_commands() {
  return kCommands;
}

}  // namespace armature::viewer
