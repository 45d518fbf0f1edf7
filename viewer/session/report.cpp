// What a session is like, as facts by name.
#include <algorithm>
#include <numbers>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "viewer/session/posing.h"
#include "viewer/session/session.h"

namespace armature::viewer {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

void report_errors(const SphereShape& spheres, const std::string& before, std::map<std::string, std::string>& facts) {
  if (!spheres.unmeasured.empty()) facts[before + "unmeasured"] = spheres.unmeasured;
  if (const auto& errors = spheres.errors) {
    facts[before + "measured"] = errors->about ? "quickly" : "in full";
    facts[before + "hausdorff_percent"] = fmt::format("{:.4g}", errors->hausdorff);
    facts[before + "mean_percent"] = fmt::format("{:.4g}", errors->mean_input_to_approximation);
  }
}

void report_model(const Model& model, std::map<std::string, std::string>& facts) {
  facts["model"] = model.name;
  if (model.mesh) {
    facts["faces"] = std::to_string(model.mesh->mesh.triangles.size());
    facts["vertices"] = std::to_string(model.mesh->mesh.positions.size());
  }
  if (model.spheres) {
    const sdk::SphereMesh& shape = *model.spheres->shape;
    facts["spheres"] = std::to_string(shape.spheres.size());
    facts["edges"] = std::to_string(shape.edges.size());
    facts["triangles"] = std::to_string(shape.triangles.size());
    report_errors(*model.spheres, "", facts);
  }
  if (model.posing) {
    facts["held"] = std::to_string(model.handle.size());
    facts["steps"] = std::to_string(model.pose->steps);
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& position : model.shown_mesh().positions) box.extend(position);
    for (const auto& [name, place] : {std::pair{"x", 0}, std::pair{"y", 1}, std::pair{"z", 2}}) {
      facts[fmt::format("lowest.{}", name)] = fmt::format("{:.5f}", box.min()[place]);
      facts[fmt::format("highest.{}", name)] = fmt::format("{:.5f}", box.max()[place]);
    }
  }
  const Editing& editing = model.editing;
  facts["edits"] = std::to_string(editing.before.size());
  facts["alike"] =
      std::to_string(std::ranges::count_if(editing.similarity, [](float similarity) { return similarity > 0.5F; }));
  if (editing.tried) {
    std::size_t moved = 0;
    for (std::size_t v = 0; v < editing.tried->mesh.positions.size(); ++v)
      moved += editing.tried->mesh.positions[v] != model.mesh->mesh.positions[v] ? 1U : 0U;
    facts["moved"] = std::to_string(moved);
  }
  const Selecting& selecting = model.selecting;
  facts["selected"] = std::to_string(selecting.selection.faces().size());
  facts["pieces"] = std::to_string(selecting.pieces);
  facts["reference"] = std::to_string(selecting.reference.size());
  facts["found"] = std::to_string(selecting.expansion ? selecting.expansion->size() : 0);
  facts["shown"] = std::to_string(selecting.shown);
  if (selecting.expansion) {
    std::size_t place = 0;
    for (const sdk::Match& match : selecting.expansion->first(8))
      facts[fmt::format("match.{}", ++place)] = fmt::format("{:.4f}", match.score);
  }
}

void report_walk(const Walk& walk, std::map<std::string, std::string>& facts) {
  facts["walk.x"] = fmt::format("{:.4f}", walk.pose().x_m);
  facts["walk.y"] = fmt::format("{:.4f}", walk.pose().y_m);
  facts["walk.heading"] = fmt::format("{:.3f}", walk.pose().heading_rad * kDegrees);
  facts["walk.walked"] = fmt::format("{:.4f}", walk.walked_m());
  facts["walk.state"] = walk.state_in_words();
  facts["walk.rounds"] = std::to_string(walk.rounds());
  facts["walk.fresh"] = walk.fresh() ? "yes" : "no";
  if (const auto& settings = walk.settings()) {
    if (settings->turn_motion) facts["walk.turn"] = navproto::name(*settings->turn_motion);
    if (settings->walk_motion) facts["walk.walk"] = navproto::name(*settings->walk_motion);
    if (settings->max_walk_m_s) facts["walk.max_walk"] = fmt::format("{:.4g}", *settings->max_walk_m_s);
    for (const auto& motion : settings->motions)
      if (motion.alpha) facts[fmt::format("walk.alpha.{}", name(motion.motion))] = fmt::format("{:.4g}", *motion.alpha);
  }
  if (const auto feed = walk.feed())
    facts["walk.feed"] = fmt::format("{}x{}", feed->intrinsics.width, feed->intrinsics.height);
  if (const auto& task = walk.task()) {
    facts["path.length"] = fmt::format("{:.3f}", task->length_m());
    facts["path.along"] = fmt::format("{:.3f}", task->along_m());
    facts["path.distance"] = fmt::format("{:.3f}", task->distance_m());
    facts["path.deviation"] = fmt::format("{:.3f}", task->mean_deviation_m());
    facts["path.time"] = fmt::format("{:.2f}", task->time().count());
    facts["path.close"] = task->close() ? "yes" : "no";
    facts["path.finished"] = task->finished() ? "yes" : "no";
  }
}

}  // namespace

std::map<std::string, std::string> Session::report() const {
  std::map<std::string, std::string> facts;
  facts["mode"] = kModes[static_cast<std::size_t>(mode)];
  facts["panel"] = kPanels[static_cast<std::size_t>(panel)];
  facts["map"] = kMaps[static_cast<std::size_t>(looks.map)];
  facts["mesh"] = kMeshLooks[static_cast<std::size_t>(looks.mesh)];
  facts["tool"] = kTools[static_cast<std::size_t>(tool)];
  facts["models"] = std::to_string(models.size());
  if (longest_frame.count() > 0) {
    facts["frame.longest_ms"] = fmt::format("{:.1f}", 1e-6 * static_cast<double>(longest_frame.count()));
    facts["frame.longest_work_ms"] = fmt::format("{:.1f}", 1e-6 * static_cast<double>(longest_work.count()));
  }
  facts["notice"] = notice;
  facts["failures"] = std::to_string(failures);
  facts["camera.azimuth"] = fmt::format("{:.3f}", camera.view.azimuth_rad * kDegrees);
  facts["camera.elevation"] = fmt::format("{:.3f}", camera.view.elevation_rad * kDegrees);
  facts["camera.distance"] = fmt::format("{:.6g}", camera.distance);
  if (picked) {
    if (picked->face.valid()) facts["picked.face"] = std::to_string(picked->face.index());
    if (picked->sphere.valid()) facts["picked.sphere"] = std::to_string(picked->sphere.index());
  }
  if (!models.empty()) report_model(*models[active_model], facts);
  if (const Model* second = other(); second != nullptr && second->spheres) {
    facts["beside.spheres"] = std::to_string(second->spheres->shape->spheres.size());
    report_errors(*second->spheres, "beside.", facts);
  }
  report_walk(walk, facts);
  return facts;
}

}  // namespace armature::viewer
