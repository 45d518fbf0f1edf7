#include "viewer/app/spheres_drawing.h"

#include <utility>

#include "viewer/app/mesh_drawing.h"
#include "viewer/scene/coarse_mesh.h"

namespace armature::viewer {
namespace {

/// As a sphere-mesh's triangles are coloured.
constexpr Palette kFacetPalette = [] {
  Palette palette = kShapePalette;
  palette.mesh = palette.inside = palette.triangle;
  return palette;
}();

/// What spans it, without its thickness.
sdk::SphereMesh flat(sdk::SphereMesh shape) {
  for (sdk::Sphere& sphere : shape.spheres) sphere.radius = 0;
  return shape;
}

}  // namespace

std::vector<std::shared_ptr<const Scene>> SpheresDrawing::make(const sdk::Sphere& frame, const sdk::SphereMesh& shape,
                                                               SpheresLook look, std::size_t coarse_cells) {
  const bool surface = look == SpheresLook::Surface;
  auto fine = std::make_shared<Scene>(frame, kShapePalette);
  fine->add(shape, {.shape = surface ? SphereMeshStyle::Shape::Surface : SphereMeshStyle::Shape::Structure});
  if (coarse_cells == 0) return {fine};
  auto coarse = std::make_shared<Scene>(frame, kFacetPalette);
  coarse->add(coarse_mesh(facets(surface ? shape : flat(shape)), coarse_cells).mesh);
  return {fine, coarse};
}

void SpheresDrawing::show(std::vector<Drawing> drawings, const Key& key) {
  fine_ = std::move(drawings.front());
  coarse_.reset();
  if (drawings.size() > 1) coarse_ = std::move(drawings.back());
  key_ = key;
  ++changes_;
}

void SpheresDrawing::clear() {
  rest();
  if (!fine_) return;
  fine_.reset();
  coarse_.reset();
  ++changes_;
}

void SpheresDrawing::follow(const std::shared_ptr<const Model>& model, SpheresLook look, bool at_once) {
  const Key key{Identity(model), model->spheres_revision, look};
  take_made();
  if (making() && asked_.model != key.model) rest();
  if (auto sent = take_sent()) show(std::move(*sent), asked_);
  if (fine_ && key_ == key) return;
  if (fine_ && key_.model != key.model) clear();
  const auto& shape = model->spheres->shape;
  if (at_once || shape->spheres.size() <= most_at_once_) {
    rest();
    std::vector<Drawing> drawings;
    for (const auto& scene : make(model->around(), *shape, look, coarse_cells_of(*shape)))
      drawings.emplace_back(*scene);
    return show(std::move(drawings), key);
  }
  if (making() || (failed_ && asked_ == key)) return;
  failed_ = false;
  asked_ = key;
  making_.start("drawing",
                [this, frame = model->around(), shape, look, cells = coarse_cells_of(*shape)](const sdk::Task&) {
                  return sdk::Expected<Job::Apply>([this, scenes = make(frame, *shape, look, cells)] {
                    for (const auto& scene : scenes) sending_.emplace_back(scene);
                  });
                });
}

}  // namespace armature::viewer
