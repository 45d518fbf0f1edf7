#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "viewer/app/sending.h"
#include "viewer/session/job.h"
#include "viewer/session/session.h"

namespace armature::viewer {

/// Colours of shapes, and of what is behind them.
inline constexpr Palette kShapePalette = {.background_top = {250, 250, 249}, .background_bottom = {226, 229, 232}};

/// A model's mesh on the card, and a coarser one of it where it is large, to draw while something moves. What is sent
/// to the card of a large mesh is made in the background and sent in bits; until it is there the drawings are those of
/// before, or none of another model.
class MeshDrawing : public BackgroundDrawing {
 public:
  /// A mesh of more faces is large; the coarser one has a grid of so many cells along its longest side.
  MeshDrawing(std::size_t most_fluent_faces, std::size_t coarse_cells)
      : most_fluent_faces_(most_fluent_faces), coarse_cells_(coarse_cells) {}

  /// Shows what the model looks like now, or as soon as it is made; `at_once`: now, however long that takes.
  void follow(const std::shared_ptr<const Model>& model, const Looks& looks, bool at_once);

  /// Nothing is shown any more.
  void clear();

  ///@{
  /// Or none.
  [[nodiscard]] const Drawing* fine() const noexcept { return fine_ ? &*fine_ : nullptr; }
  [[nodiscard]] const Drawing* coarse() const noexcept { return coarse_ ? &*coarse_ : nullptr; }
  ///@}
 private:
  /// What is drawn.
  struct Shape {
    Identity model = {};
    std::uint64_t revision = 0;
    MeshLook look = MeshLook::Solid;
    bool wireframe = false;
    friend bool operator==(const Shape&, const Shape&) = default;
  };
  struct Colours {
    std::uint64_t revision = 0;
    MapKind map = MapKind::None;
    friend bool operator==(const Colours&, const Colours&) = default;
  };
  using CornerColours = std::vector<std::array<sdk::Colour, 3>>;
  struct Source;  // what drawings are made from
  /// What is sent to the card: scenes for another shape, else colours alone.
  struct Made {
    std::shared_ptr<Scene> fine = {}, coarse = {};
    std::vector<sdk::FaceId> coarse_source = {};
    CornerColours fine_colours = {}, coarse_colours = {};
  };
  [[nodiscard]] Source source_of(const std::shared_ptr<const Model>& model, const Looks& looks, bool is_new) const;
  [[nodiscard]] static Made make(const Source& source);
  void recolour(const Made& made, const Shape& shape, const Colours& colours);
  void send(Made made);
  void go_on();

  std::size_t most_fluent_faces_, coarse_cells_;
  std::optional<Drawing> fine_, coarse_;
  std::vector<sdk::FaceId> coarse_source_, sent_source_;  // by face of the coarse mesh: which face of the mesh it was
  Shape shape_, asked_;                                   // of the drawings; of those that are being made
  Colours colours_, asked_colours_;
};

}  // namespace armature::viewer
