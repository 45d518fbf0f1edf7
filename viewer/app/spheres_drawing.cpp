#include "viewer/app/spheres_drawing.h"

#include <utility>

#include "viewer/app/mesh_drawing.h"

namespace armature::viewer {
namespace {

Scene scene_of(const sdk::Sphere& frame, const sdk::SphereMesh& shape, SpheresLook look) {
  Scene scene(frame, kShapePalette);
  scene.add(shape, {.shape = look == SpheresLook::Surface ? SphereMeshStyle::Shape::Surface
                                                          : SphereMeshStyle::Shape::Structure});
  return scene;
}

}  // namespace

void SpheresDrawing::show(Drawing drawing, const Key& key) {
  drawing_ = std::move(drawing);
  key_ = key;
  ++changes_;
}

void SpheresDrawing::clear() {
  rest();
  if (!drawing_) return;
  drawing_.reset();
  ++changes_;
}

void SpheresDrawing::follow(const std::shared_ptr<const Model>& model, SpheresLook look, bool at_once) {
  const Key key{Identity(model), model->spheres_revision, look};
  take_made();
  if (making() && asked_.model != key.model) rest();
  if (auto sent = take_sent()) show(std::move(sent->front()), asked_);
  if (drawing_ && key_ == key) return;
  if (drawing_ && key_.model != key.model) clear();
  const auto& shape = model->spheres->shape;
  if (at_once || shape->spheres.size() <= most_at_once_) {
    rest();
    return show(Drawing(scene_of(model->around(), *shape, look)), key);
  }
  if (making() || (failed_ && asked_ == key)) return;
  failed_ = false;
  asked_ = key;
  making_.start("drawing", [this, frame = model->around(), shape, look](const sdk::Task&) {
    auto scene = std::make_shared<const Scene>(scene_of(frame, *shape, look));
    return sdk::Expected<Job::Apply>([this, scene] { sending_.emplace_back(scene); });
  });
}

}  // namespace armature::viewer
