#include "viewer/app/view_painter.h"

#include <algorithm>
#include <chrono>
#include <limits>

namespace armature::viewer {
namespace {

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
  auto quick = Painter::create(), careful = Painter::create();
  if (!quick) return tl::unexpected(quick.error());
  if (!careful) return tl::unexpected(careful.error());
  return ViewPainter(std::move(*quick), std::move(*careful), options);
}

void ViewPainter::keep(Kept& kept, int look, const Scene& scene) {
  kept.drawing.emplace(scene);
  kept.look = look;
  kept.made = ++made_;
}

void ViewPainter::show(const Kept& kept) {
  drawings_.push_back(&*kept.drawing);
  shows_.push_back(kept.made);
}

void ViewPainter::gather_shapes(const Looks& looks, const std::shared_ptr<const Model>& held, bool at_once) {
  const Model& model = *held;
  if (model.mesh && looks.mesh != MeshLook::Off) {
    mesh_->follow(held, looks, at_once);
    if (mesh_->fine() != nullptr) drawings_.push_back(mesh_->fine());
    shows_.push_back(-static_cast<double>(mesh_->changes()));
  }
  if (model.spheres && looks.spheres != SpheresLook::Off) {
    spheres_->follow(held, looks.spheres, at_once);
    if (spheres_->fine() != nullptr) drawings_.push_back(spheres_->fine());
    shows_.push_back(0.5 + static_cast<double>(spheres_->changes()));
  }
}

void ViewPainter::gather_city(const Walk& walk) {
  // Its size is how far corners are darker, not how large the city is.
  const sdk::Sphere frame{Eigen::Vector3d::Zero(), 6};
  if (!city_.drawing) {
    Scene scene(frame, kCity);
    scene.add(walk.city().buildings);
    scene.add(walk.city().trees);
    keep(city_, 0, scene);
  }
  show(city_);
  if (!walk.task()) return;
  const int look = walk.task()->close() ? 1 : 0;
  if (ribbon_.look != look || !ribbon_.drawing) {
    Scene scene(frame, kCity);
    scene.add(make_ribbon(walk.task()->path(), 1.0, walk.task()->close() ? kClose : kFar));
    keep(ribbon_, look, scene);
  }
  show(ribbon_);
}

sdk::Expected<void> ViewPainter::paint(const Session& session, const std::shared_ptr<const Model>& model, int width,
                                       int height, bool careful) {
  drawings_.clear();
  shows_.clear();
  const double aspect = static_cast<double>(width) / height;
  const bool walks = session.mode == Mode::Walk;
  if (!model) {
    mesh_->clear();
    spheres_->clear();
  }
  if (walks || !model || !model->mesh || session.looks.mesh == MeshLook::Off) mesh_->rest();
  if (walks || !model || !model->spheres || session.looks.spheres == SpheresLook::Off) spheres_->rest();
  if (walks) {
    gather_city(session.walk);
  } else {
    if (model) gather_shapes(session.looks, model, careful);
  }
  if (drawings_.empty()) {
    if (!nothing_.drawing) keep(nothing_, 0, Scene({Eigen::Vector3d::Zero(), 1}, kShapePalette));
    show(nothing_);
  }
  const Camera camera =
      walks ? session.walk.camera(aspect) : session.camera.camera(model ? model->extent() : session.around(), aspect);
  const Eigen::Matrix4d view = camera.view_from_world.matrix();
  shows_.insert(shows_.end(), view.data(), view.data() + 16);
  shows_.insert(shows_.end(),
                {camera.half_width, camera.half_height, camera.near, camera.far, static_cast<double>(width),
                 static_cast<double>(height), session.looks.matcap ? 1.0 : 0.0});
  if (shows_ != shown_ || (careful && !finest_)) {
    std::swap(shown_, shows_);
    finest_ = careful;
    rough_ = true;
    spent_ms_ = 0;
    if (auto begun = careful_.begin(drawings_, camera, width, height,
                                    {.samples_a_side = careful ? 0 : 2, .obscurance = !session.looks.matcap});
        !begun)
      return begun;
    if (!careful && careful_ms_ <= options_.fluent_ms) {
      go_on(options_.fluent_ms);
      careful_ms_ = spent_ms_;
    }
    if (rough_ && !careful) return paint_quickly(camera, width, height);
  }
  // Once nothing moves there is time for care.
  if (rough_) go_on(careful ? std::numeric_limits<double>::infinity() : options_.patience_ms);
  return {};
}

/// With few samples, without dark corners, large shapes coarser.
sdk::Expected<void> ViewPainter::paint_quickly(const Camera& camera, int width, int height) {
  if (mesh_->coarse() != nullptr) std::ranges::replace(drawings_, mesh_->fine(), mesh_->coarse());
  if (spheres_->coarse() != nullptr) std::ranges::replace(drawings_, spheres_->fine(), spheres_->coarse());
  ++painted_;
  const auto start = std::chrono::steady_clock::now();
  const int share = halves_ ? 2 : 1;
  auto painted = quick_.paint(drawings_, camera, std::max(1, width / share), std::max(1, height / share),
                              {.samples_a_side = 1, .obscurance = false, .most_ray_cast = options_.most_fluent_cones});
  glFinish();
  // All pixels take four times as long, at most.
  halves_ = (halves_ ? 4 : 1) * milliseconds_since(start) > options_.slow_ms;
  return painted;
}

/// Paints bits of the careful picture, one at least, for about so long.
void ViewPainter::go_on(double budget_ms) {
  const auto start = std::chrono::steady_clock::now();
  while (rough_) {
    rough_ = !careful_.go_on();
    glFinish();
    if (milliseconds_since(start) > budget_ms) break;
  }
  spent_ms_ += milliseconds_since(start);
  if (rough_) return;
  careful_ms_ = spent_ms_;
  ++painted_;
}

}  // namespace armature::viewer
