#include "viewer/session/model.h"

#include <algorithm>
#include <system_error>

#include <armature/sdk/hierarchy/hierarchy_file.h>
#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/io/sphere_mesh_file.h>
#include <armature/sdk/io/write_mesh.h>

#include "viewer/scene/scene.h"
#include "viewer/scene/shading.h"
#include "viewer/session/extent.h"
#include "viewer/session/posing.h"

namespace armature::viewer {
std::string lower_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return extension;
}

MeshShape::MeshShape(sdk::Mesh of)
    : mesh(std::move(of)),
      surface(mesh),
      around(sphere_around(mesh)),
      normals(corner_normals(mesh, MeshStyle().crease_rad)) {}

sdk::Expected<std::shared_ptr<const sdk::PartModel>> MeshShape::parts(const sdk::Task& task) const {
  return parts_.get(task, [this](const sdk::Task& t) { return sdk::PartModel::build(surface, t); });
}

sdk::Expected<std::shared_ptr<const sdk::ComponentIndex>> MeshShape::components(const sdk::Task& task) const {
  return components_.get(task,
                         [this](const sdk::Task& t) { return sdk::ComponentIndex::build(mesh, surface.adjacency, t); });
}

sdk::BoundaryDrag boundary_drag(const sdk::Surface& surface, const sdk::SurfacePoint& from, const sdk::SurfacePoint& to,
                                double snap) {
  const double way = (to.point - from.point).norm();
  return {.from = from, .to = to, .reach = std::max(3 * way, 0.03 * surface.diagonal), .snap = snap * surface.diagonal};
}

void SphereShape::show(std::shared_ptr<const sdk::SphereMesh> other) {
  shape = std::move(other);
  around = sphere_around(*shape);
  changed();
}

void SphereShape::changed() {
  tree.reset();
  errors.reset();
  unmeasured.clear();
}

void Model::go_to(std::size_t count) {
  spheres->cursor->go_to(count);
  set_refined(std::make_shared<const sdk::SphereMesh>(spheres->cursor->sphere_mesh()));
}

void Model::go_to(Level& level) {
  std::swap(*spheres->cursor, level.cursor);
  std::swap(spheres->shape, level.shape);
  std::swap(spheres->around, level.around);
  spheres->changed();
  spheres->tree = std::move(level.tree);
  ++spheres_revision;
}

Level make_level(const sdk::LevelCursor& from, std::size_t spheres) {
  sdk::LevelCursor cursor = from;
  cursor.go_to(spheres);
  auto shape = std::make_shared<const sdk::SphereMesh>(cursor.sphere_mesh());
  auto tree = std::make_shared<const sdk::SphereMeshTree>(*shape);
  const sdk::Sphere around = sphere_around(*shape);
  return {std::move(cursor), std::move(shape), around, std::move(tree)};
}

void Model::set_spheres(sdk::SphereMesh shape) {
  spheres.emplace();
  set_refined(std::make_shared<const sdk::SphereMesh>(std::move(shape)));
}

void Model::set_refined(std::shared_ptr<const sdk::SphereMesh> shape) {
  spheres->show(std::move(shape));
  ++spheres_revision;
}

void Model::set_hierarchy(std::shared_ptr<const sdk::Hierarchy> hierarchy, std::size_t count) {
  spheres.emplace();
  spheres->cursor.emplace(*hierarchy, std::clamp(count, hierarchy->min_spheres(), hierarchy->leaf_count()));
  spheres->hierarchy = std::move(hierarchy);
  set_refined(std::make_shared<const sdk::SphereMesh>(spheres->cursor->sphere_mesh()));
}

std::shared_ptr<SphereShape> Model::take_spheres() {
  if (!spheres) return nullptr;
  auto taken = std::make_shared<SphereShape>(std::move(*spheres));
  spheres.reset();
  ++spheres_revision;
  return taken;
}

void Model::put_spheres(std::shared_ptr<SphereShape> taken) {
  spheres.reset();
  if (taken) spheres = std::move(*taken);
  ++spheres_revision;
}

void Model::lay(std::shared_ptr<const Pose> as) {
  pose = std::move(as);
  previewed.reset();
  set_refined(pose->shape);
  spheres->tree = pose->tree;
  ++mesh_revision;
}

void Model::preview(std::shared_ptr<const Pose> as) {
  previewed = std::move(as);
  const Pose& shown = *(previewed ? previewed : pose);
  set_refined(shown.shape);
  spheres->tree = shown.tree;
  ++mesh_revision;
}

const sdk::Mesh& Model::shown_mesh() const {
  if (posing) return (previewed ? previewed : pose)->mesh;
  return editing.tried ? editing.tried->mesh : mesh->mesh;
}

sdk::Sphere Model::around() const {
  return mesh ? mesh->around : spheres ? spheres->around : sdk::Sphere{Eigen::Vector3d::Zero(), 1};
}

sdk::Sphere Model::lasting_extent() const {
  return posing ? pose->around : extent();
}

sdk::Sphere Model::extent() const {
  if (posing) return (previewed ? previewed : pose)->around;
  if (!mesh) return around();
  const sdk::Sphere& shown = editing.tried ? editing.tried->around : mesh->around;
  return spheres ? widened(shown, spheres->around) : shown;
}

const sdk::SphereMeshTree& Model::sphere_tree() {
  if (!spheres->tree) spheres->tree = std::make_shared<const sdk::SphereMeshTree>(*spheres->shape);
  return *spheres->tree;
}

sdk::Expected<std::shared_ptr<Model>> read_model(const std::filesystem::path& path, const sdk::Task& task) {
  constexpr const char* kFormats =
      "a mesh (.off, .obj, .ply, .stl or what assimp reads), a sphere-mesh (.ma, .ply) or a hierarchy (.smh)";
  std::error_code none;
  if (std::filesystem::is_directory(path, none))
    return sdk::fail(path.string() + ": is a folder; expected " + kFormats);
  if (std::filesystem::exists(path, none) && !path.has_extension())
    return sdk::fail(path.string() + ": has no extension to tell its format; expected " + kFormats);
  auto model = std::make_shared<Model>();
  model->name = path.stem().string();
  model->path = path;
  if (lower_extension(path) == ".smh") {
    auto hierarchy = sdk::read_hierarchy(path, task);
    if (!hierarchy) return tl::unexpected(hierarchy.error());
    model->set_hierarchy(std::make_shared<const sdk::Hierarchy>(std::move(*hierarchy)), kFirstLevel);
  } else if (sdk::holds_sphere_mesh(path)) {
    auto shape = sdk::read_sphere_mesh(path, task);
    if (!shape) return tl::unexpected(shape.error());
    model->set_spheres(std::move(*shape));
    (void)model->sphere_tree();  // here it keeps nobody waiting
  } else {
    auto mesh = sdk::read_mesh(path, {}, task);
    if (!mesh) return tl::unexpected(mesh.error());
    task.report("looking at the mesh", 0);
    model->mesh = std::make_shared<const MeshShape>(std::move(*mesh));
  }
  if (task.stopped()) return tl::unexpected(sdk::cancelled().value());
  return model;
}

sdk::Expected<void> write_model(const Model& model, const std::filesystem::path& path, bool spheres) {
  const std::string extension = lower_extension(path);
  const auto lacks = [&](const char* what) {
    return sdk::fail(path.string() + ": " + model.name + " has no " + what + " to write; make one first");
  };
  if (extension == ".smh") {
    if (!model.spheres || !model.spheres->hierarchy) return lacks("hierarchy");
    return sdk::write_hierarchy(*model.spheres->hierarchy, path);
  }
  const bool as_spheres =
      extension == ".ma" || extension == ".urdf" || (extension == ".ply" && (spheres || !model.mesh));
  if (as_spheres) {
    if (!model.spheres) return lacks("sphere-mesh");
    return sdk::write_sphere_mesh(*model.spheres->shape, path);
  }
  if (extension != ".obj" && extension != ".off" && extension != ".ply")
    return sdk::fail(path.string() + ": expected a name that ends in .obj, .off, .ply, .ma, .urdf or .smh");
  if (!model.mesh) return lacks("mesh");
  if (model.editing.tried) return sdk::fail("keep the edit that is shown, or drop it, before the mesh is written");
  return sdk::write_mesh(model.shown_mesh(), path);
}

}  // namespace armature::viewer
