#include "viewer/app/view_painter.h"

#include <algorithm>
#include <chrono>

#include "viewer/session/coarse_mesh.h"
#include "viewer/session/maps.h"

namespace armature::viewer {
namespace {

constexpr Palette kShapes = {.background_top = {250, 250, 249}, .background_bottom = {226, 229, 232}};
constexpr Palette kCity = {.sphere = {126, 158, 104},
                           .edge = {126, 158, 104},
                           .inside = {196, 194, 190},
                           .background_top = {126, 172, 216},
                           .background_bottom = {224, 234, 240}};
constexpr sdk::Colour kClose = {66, 168, 94}, kFar = {206, 66, 52};

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

sdk::Expected<ViewPainter> ViewPainter::create(const Options& options) {
  auto painter = Painter::create();
  if (!painter) return tl::unexpected(painter.error());
  return ViewPainter(std::move(*painter), options);
}

void ViewPainter::keep(Kept& kept, Key key, const Scene& scene) {
  kept.drawing.reset();  // first: two of a million triangles are a lot
  kept.drawing.emplace(scene);
  kept.key = std::move(key);
  kept.made = ++made_;
}

void ViewPainter::show(const Kept& kept) {
  drawings_.push_back(&*kept.drawing);
  shows_.push_back(kept.made);
}

void ViewPainter::gather_mesh(const Looks& looks, const std::shared_ptr<const Model>& held) {
  const Model& model = *held;
  const Key key{held, model.mesh_revision, static_cast<int>(looks.mesh), looks.wireframe};
  const Colours wanted{model.colour_revision, looks.map};
  const Layer layer = looks.mesh == MeshLook::Glass ? Layer::Glass : Layer::Solid;
  const bool is_new = mesh_.key != key || !mesh_.drawing;
  if (is_new || colours_ != wanted) {
    const auto colours = corner_colours(model, looks.map, kShapes.mesh);
    if (is_new) {
      MeshStyle style{.layer = layer, .wireframe = looks.wireframe, .colours = colours};
      if (!model.posing) style.normals = model.editing.tried ? model.editing.tried->normals : model.mesh->normals;
      Scene scene(model.around(), kShapes);
      scene.add(model.shown_mesh(), style);
      keep(mesh_, key, scene);
      keep_coarse(model, layer, colours);
    } else {
      mesh_.drawing->recolour(layer, colours);
      if (coarse_) coarse_->recolour(layer, coarse_colours(colours));
      mesh_.made = ++made_;
    }
    colours_ = wanted;
  }
  show(mesh_);
}

/// Large meshes have a second drawing, of fewer faces.
void ViewPainter::keep_coarse(const Model& model, Layer layer, std::span<const CornerColours> colours) {
  coarse_.reset();
  if (model.posing || model.shown_mesh().triangles.size() <= options_.most_fluent_faces) return;
  CoarseMesh coarse = coarse_mesh(model.shown_mesh(), options_.coarse_cells);
  coarse_source_ = std::move(coarse.source);
  const auto its_colours = coarse_colours(colours);
  Scene scene(model.around(), kShapes);
  scene.add(coarse.mesh, {.layer = layer, .colours = its_colours});
  coarse_.emplace(scene);
}

std::vector<ViewPainter::CornerColours> ViewPainter::coarse_colours(std::span<const CornerColours> colours) const {
  std::vector<CornerColours> result;
  result.reserve(coarse_source_.size());
  for (const sdk::FaceId face : coarse_source_) result.push_back(colours[face.index()]);
  return result;
}

void ViewPainter::gather_shapes(const Looks& looks, const std::shared_ptr<const Model>& held) {
  const Model& model = *held;
  const sdk::Sphere frame = model.around();
  if (model.mesh && looks.mesh != MeshLook::Off) gather_mesh(looks, held);
  if (model.spheres && looks.spheres != SpheresLook::Off) {
    const Key key{held, model.spheres_revision, static_cast<int>(looks.spheres), false};
    if (spheres_.key != key || !spheres_.drawing) {
      Scene scene(frame, kShapes);
      scene.add(model.spheres->shape,
                {.shape = looks.spheres == SpheresLook::Surface ? SphereMeshStyle::Shape::Surface
                                                                : SphereMeshStyle::Shape::Structure});
      keep(spheres_, key, scene);
    }
    show(spheres_);
  }
}

void ViewPainter::gather_city(const Walk& walk) {
  // Its size is how far corners are darker, not how large the city is.
  const sdk::Sphere frame{Eigen::Vector3d::Zero(), 6};
  if (!city_.drawing) {
    Scene scene(frame, kCity);
    scene.add(walk.city().buildings);
    scene.add(walk.city().trees);
    keep(city_, {}, scene);
  }
  show(city_);
  if (!walk.task()) return;
  const Key key{.look = walk.task()->close() ? 1 : 0};
  if (ribbon_.key != key || !ribbon_.drawing) {
    Scene scene(frame, kCity);
    scene.add(make_ribbon(walk.task()->path(), 1.0, walk.task()->close() ? kClose : kFar));
    keep(ribbon_, key, scene);
  }
  show(ribbon_);
}

sdk::Expected<void> ViewPainter::paint(const Session& session, const std::shared_ptr<const Model>& model, int width,
                                       int height, bool careful) {
  drawings_.clear();
  shows_.clear();
  const double aspect = static_cast<double>(width) / height;
  const bool walks = session.mode == Mode::Walk;
  if (walks) {
    gather_city(session.walk);
  } else {
    if (model) gather_shapes(session.looks, model);
  }
  if (drawings_.empty()) {
    if (!nothing_.drawing) keep(nothing_, {}, Scene({Eigen::Vector3d::Zero(), 1}, kShapes));
    show(nothing_);
  }
  const Camera camera =
      walks ? session.walk.camera(aspect) : session.camera.camera(model ? model->around() : session.around(), aspect);
  const Eigen::Matrix4d view = camera.view_from_world.matrix();
  shows_.insert(shows_.end(), view.data(), view.data() + 16);
  shows_.insert(shows_.end(),
                {camera.half_width, camera.half_height, camera.near, camera.far, static_cast<double>(width),
                 static_cast<double>(height), session.looks.matcap ? 1.0 : 0.0});
  const bool moved = shows_ != shown_;
  if (!moved && !rough_) return {};
  // Once nothing moves there is time for care.
  const bool roughly = moved && !careful && careful_ms_ > options_.fluent_ms;
  if (roughly && coarse_ && mesh_.drawing)
    std::ranges::replace(drawings_, static_cast<const Drawing*>(&*mesh_.drawing), &*coarse_);
  const auto start = std::chrono::steady_clock::now();
  const PaintOptions options{.samples_a_side = roughly   ? 1
                                               : careful ? 0
                                                         : 2,
                             .obscurance = !roughly && !session.looks.matcap};
  if (auto painted = painter_.paint(drawings_, camera, width, height, options); !painted) return painted;
  glFinish();
  ++painted_;
  if (!roughly) careful_ms_ = milliseconds_since(start);
  rough_ = roughly;
  std::swap(shown_, shows_);
  return {};
}

}  // namespace armature::viewer
