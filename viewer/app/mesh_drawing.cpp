#include "viewer/app/mesh_drawing.h"

#include <span>
#include <utility>

#include "viewer/scene/coarse_mesh.h"
#include "viewer/session/maps.h"
#include "viewer/session/posing.h"

namespace armature::viewer {

/// Of a model at some moment; what may change is copied.
struct MeshDrawing::Source {
  std::shared_ptr<const MeshShape> shape;  // holds what follows,
  std::shared_ptr<const ShadedMesh> tried;
  std::shared_ptr<const Pose> pose;
  const sdk::Mesh& mesh() const { return pose ? pose->mesh : tried ? tried->mesh : shape->mesh; }
  std::span<const std::array<Eigen::Vector3d, 3>> normals() const {
    if (pose) return {};
    return tried ? tried->normals : shape->normals;
  }
  sdk::Sphere frame;
  Layer layer = Layer::Solid;
  bool wireframe = false;
  MeshPaint paint;
  bool is_new = true;                      // scenes are wanted, not colours alone
  std::size_t coarse_cells = 0;            // 0: no coarse one
  std::vector<sdk::FaceId> coarse_source;  // where colours alone are wanted
};

MeshDrawing::Source MeshDrawing::source_of(const std::shared_ptr<const Model>& model, const Looks& looks,
                                           bool is_new) const {
  const bool has_coarse = model->shown_mesh().triangles.size() > most_fluent_faces_;
  Source source{.shape = model->mesh,
                .tried = model->editing.tried,
                .pose = {},
                .frame = model->around(),
                .layer = looks.mesh == MeshLook::Glass ? Layer::Glass : Layer::Solid,
                .wireframe = looks.wireframe,
                .paint = paint_of(*model, looks.map),
                .is_new = is_new,
                .coarse_cells = has_coarse ? coarse_cells_ : 0,
                .coarse_source = {}};
  if (model->posing) source.pose = model->previewed ? model->previewed : model->pose;
  if (!is_new) source.coarse_source = coarse_source_;
  return source;
}

MeshDrawing::Made MeshDrawing::make(const Source& source) {
  const sdk::Mesh& mesh = source.mesh();
  Made made;
  made.fine_colours = corner_colours(mesh, source.shape->surface.adjacency, source.paint, kShapePalette.mesh);
  made.coarse_source = source.coarse_source;
  CoarseMesh coarse;
  if (source.is_new && source.coarse_cells > 0) {
    coarse = coarse_mesh(mesh, source.coarse_cells);
    made.coarse_source = std::move(coarse.source);
  }
  for (const sdk::FaceId face : made.coarse_source) made.coarse_colours.push_back(made.fine_colours[face.index()]);
  if (!source.is_new) return made;
  made.fine = std::make_shared<Scene>(source.frame, kShapePalette);
  made.fine->add(mesh, {.layer = source.layer,
                        .wireframe = source.wireframe,
                        .normals = source.normals(),
                        .colours = made.fine_colours});
  if (source.coarse_cells == 0) return made;
  made.coarse = std::make_shared<Scene>(source.frame, kShapePalette);
  made.coarse->add(coarse.mesh, {.layer = source.layer, .colours = made.coarse_colours});
  return made;
}

void MeshDrawing::recolour(const Made& made, const Shape& shape, const Colours& colours) {
  const Layer layer = shape.look == MeshLook::Glass ? Layer::Glass : Layer::Solid;
  fine_->recolour(layer, made.fine_colours);
  if (coarse_) coarse_->recolour(layer, made.coarse_colours);
  colours_ = colours;
  ++changes_;
}

void MeshDrawing::send(Made made) {
  sent_source_ = std::move(made.coarse_source);
  sending_.emplace_back(std::move(made.fine));
  if (made.coarse) sending_.emplace_back(std::move(made.coarse));
}

/// Sends on, and shows it once all of it is there.
void MeshDrawing::go_on() {
  auto sent = take_sent();
  if (!sent) return;
  fine_ = std::move(sent->front());
  coarse_.reset();
  if (sent->size() > 1) coarse_ = std::move(sent->back());
  coarse_source_ = std::move(sent_source_);
  shape_ = asked_;
  colours_ = asked_colours_;
  ++changes_;
}

void MeshDrawing::clear() {
  rest();
  if (!fine_) return;
  fine_.reset();
  coarse_.reset();
  ++changes_;
}

void MeshDrawing::follow(const std::shared_ptr<const Model>& model, const Looks& looks, bool at_once) {
  const Shape shape{Identity(model), model->mesh_revision, looks.mesh, looks.wireframe};
  const Colours colours{model->colour_revision, looks.map};
  take_made();
  if (making() && asked_.model != shape.model) rest();
  go_on();
  const auto is_shown = [&] { return fine_ && shape_ == shape && colours_ == colours; };
  if (is_shown()) return;
  if (fine_ && shape_.model != shape.model) clear();
  const bool at_last = at_once || model->shown_mesh().triangles.size() <= most_fluent_faces_;
  if (at_last) rest();
  if (!at_last && (making() || (failed_ && asked_ == shape && asked_colours_ == colours))) return;
  failed_ = false;
  const bool is_new = !fine_ || shape_ != shape;
  asked_ = shape;
  asked_colours_ = colours;
  const auto take = [this, shape, colours](const std::shared_ptr<Made>& made) {
    if (!made->fine) return recolour(*made, shape, colours);
    send(std::move(*made));
  };
  if (at_last) {
    take(std::make_shared<Made>(make(source_of(model, looks, is_new))));
    while (!sending_.empty()) go_on();
    return;
  }
  making_.start("drawing", [take, source = source_of(model, looks, is_new)](const sdk::Task&) {
    auto made = std::make_shared<Made>(make(source));
    return sdk::Expected<Job::Apply>([take, made] { take(made); });
  });
}

}  // namespace armature::viewer
