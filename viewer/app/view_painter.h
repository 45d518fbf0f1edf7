#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "viewer/app/mesh_drawing.h"
#include "viewer/app/spheres_drawing.h"
#include "viewer/render/painter.h"
#include "viewer/session/session.h"

namespace armature::viewer {

/// Paints what a session shows, and keeps on the card what does not change. Made, used and deleted while its context is
/// current.
class ViewPainter {
 public:
  struct Options {
    double fluent_ms = 25;                    ///< a careful picture that takes longer is left for when nothing moves,
    double patience_ms = 30;                  ///< and then painted in bits of about so long;
    double slow_ms = 70;                      ///< after a quick one that takes longer they have half the pixels a side
    std::size_t most_fluent_faces = 200'000;  ///< a mesh or sphere-mesh of more is then drawn coarser while it moves,
    std::size_t coarse_cells = 128;           ///< by a grid of so many cells along its longest side
    GLsizei most_fluent_cones = 100'000;      ///< of a sphere-mesh of more only triangles are drawn while it moves,
    std::size_t most_fluent_spheres = 5'000;  ///< a sphere-mesh of more is made in the background
  };
  [[nodiscard]] static sdk::Expected<ViewPainter> create(const Options& options);
  [[nodiscard]] static sdk::Expected<ViewPainter> create() { return create(Options()); }

  /// Paints the view again where it has changed. While it moves, as carefully as leaves it fluent; `careful`: always
  /// with all care. The picture is in `picture()`.
  [[nodiscard]] sdk::Expected<void> paint(const Session& session, int width, int height, bool careful) {
    return paint(session, session.models.empty() ? nullptr : session.models[session.active_model], width, height,
                 careful);
  }
  /// The same of another model, or of none.
  [[nodiscard]] sdk::Expected<void> paint(const Session& session, const std::shared_ptr<const Model>& model, int width,
                                          int height, bool careful);
  /// The framebuffer that holds it.
  /// It may have fewer pixels than the view.
  [[nodiscard]] const Painter& picture() const noexcept { return rough_ ? quick_ : careful_; }
  /// Nothing more of it is shown: what is being made for it is not wanted, nor is a better picture, until it paints.
  void rest() {
    mesh_->rest();
    spheres_->rest();
    shown_.clear();
    rough_ = false;
  }
  /// What kept something from being drawn, once.
  [[nodiscard]] std::optional<std::string> take_complaint() {
    auto complaint = mesh_->take_complaint();
    return complaint ? complaint : spheres_->take_complaint();
  }
  /// How many pictures it has painted.
  [[nodiscard]] std::size_t painted() const noexcept { return painted_; }
  /// Whether the picture is rougher or older than it could be and should be painted again soon.
  [[nodiscard]] bool rough() const noexcept { return rough_ || making(); }
  /// Whether that is all there is to do until something that is made in the background is there.
  [[nodiscard]] bool awaits() const noexcept { return !rough_ && making(); }
  /// Whether something is being made in the background; its destructor waits for that.
  [[nodiscard]] bool making() const noexcept { return mesh_->making() || spheres_->making(); }

 private:
  /// A drawing, and how it looks; another one is made where that differs.
  struct Kept {
    int look = 0;
    std::optional<Drawing> drawing = {};
    double made = 0;  // the how-manyth drawing it is
  };

  ViewPainter(Painter quick, Painter careful, const Options& options)
      : options_(options),
        quick_(std::move(quick)),
        careful_(std::move(careful)),
        mesh_(std::make_unique<MeshDrawing>(options.most_fluent_faces, options.coarse_cells)),
        spheres_(std::make_unique<SpheresDrawing>(options.most_fluent_spheres, options.most_fluent_faces,
                                                  options.coarse_cells)) {}
  void keep(Kept& kept, int look, const Scene& scene);
  void show(const Kept& kept);
  void gather_shapes(const Looks& looks, const std::shared_ptr<const Model>& held, bool at_once);
  void gather_city(const Walk& walk);
  [[nodiscard]] sdk::Expected<void> paint_quickly(const Camera& camera, int width, int height);
  void go_on(double budget_ms);

  Options options_;
  Painter quick_, careful_;
  std::unique_ptr<MeshDrawing> mesh_;
  std::unique_ptr<SpheresDrawing> spheres_;
  Kept city_, ribbon_, nothing_;
  double made_ = 0;
  std::vector<const Drawing*> drawings_;
  // What the picture is to show and shows: which drawings, from where.
  std::vector<double> shows_, shown_;
  bool rough_ = false;   // the careful picture is not done
  bool finest_ = false;  // it has, or will have, as many samples as it can
  std::size_t painted_ = 0;
  double careful_ms_ = 0, spent_ms_ = 0;  // what the last careful picture took, and this one so far
  bool halves_ = false;                   // quick pictures have half the pixels a side
};

}  // namespace armature::viewer
