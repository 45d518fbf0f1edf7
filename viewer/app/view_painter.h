#pragma once

#include <chrono>
#include <memory>
#include <optional>

#include "viewer/render/painter.h"
#include "viewer/session/session.h"

namespace armature::viewer {

/// Paints what a session shows, and keeps on the card what does not change. Made, used and deleted while its context is
/// current.
class ViewPainter {
 public:
  struct Options {
    double fluent_ms = 25;                    ///< a careful picture that takes longer is left for when nothing moves
    std::size_t most_fluent_faces = 200'000;  ///< a mesh of more is then drawn coarser while it moves,
    std::size_t coarse_cells = 128;           ///< by a grid of so many cells along its longest side
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
  [[nodiscard]] GLuint picture() const noexcept { return painter_.framebuffer(); }
  /// How many pictures it has painted.
  [[nodiscard]] std::size_t painted() const noexcept { return painted_; }
  /// Whether the picture is rougher than it could be and should be painted again soon.
  [[nodiscard]] bool rough() const noexcept { return rough_; }

 private:
  /// What a drawing was made from; another one is made where it differs.
  struct Key {
    std::shared_ptr<const void> model = nullptr;  // held, so that no other takes its place
    std::uint64_t revision = 0;
    int look = 0;
    bool wireframe = false;
    friend bool operator==(const Key&, const Key&) = default;
  };
  /// The same of the mesh's colours.
  struct Colours {
    std::uint64_t revision = 0;
    MapKind map = MapKind::None;
    friend bool operator==(const Colours&, const Colours&) = default;
  };
  struct Kept {
    Key key = {};
    std::optional<Drawing> drawing = {};
    double made = 0;  // the how-manyth drawing it is
  };

  ViewPainter(Painter painter, const Options& options) : options_(options), painter_(std::move(painter)) {}
  void keep(Kept& kept, Key key, const Scene& scene);
  void show(const Kept& kept);
  using CornerColours = std::array<sdk::Colour, 3>;
  void gather_mesh(const Looks& looks, const std::shared_ptr<const Model>& held);
  void keep_coarse(const Model& model, Layer layer, std::span<const CornerColours> colours);
  [[nodiscard]] std::vector<CornerColours> coarse_colours(std::span<const CornerColours> colours) const;
  void gather_shapes(const Looks& looks, const std::shared_ptr<const Model>& held);
  void gather_city(const Walk& walk);

  Options options_;
  Painter painter_;
  Kept mesh_, spheres_, city_, ribbon_, nothing_;
  Colours colours_;                         // of mesh_
  std::optional<Drawing> coarse_;           // of a large mesh_, to draw while something moves
  std::vector<sdk::FaceId> coarse_source_;  // by face of that: which face of the mesh it was
  double made_ = 0;
  std::vector<const Drawing*> drawings_;
  // What the picture is to show and shows: which drawings, from where.
  std::vector<double> shows_, shown_;
  bool rough_ = false;
  std::size_t painted_ = 0;
  double careful_ms_ = 0;  // the last careful picture took
};

}  // namespace armature::viewer
