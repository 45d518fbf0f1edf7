#pragma once

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

/// A model's sphere-mesh on the card, and a coarse mesh of its flat parts where these are many, to draw while something
/// moves. That of many spheres is made in the background and sent in bits; until it is there the drawings are those of
/// before, or none of another model.
class SpheresDrawing : public BackgroundDrawing {
 public:
  /// A sphere-mesh of more spheres is large. One of more facets has a coarse mesh, by a grid of so many cells along its
  /// longest side.
  SpheresDrawing(std::size_t most_at_once, std::size_t most_fluent_facets, std::size_t coarse_cells)
      : most_at_once_(most_at_once), most_fluent_facets_(most_fluent_facets), coarse_cells_(coarse_cells) {}

  /// Shows what the spheres look like now, or as soon as it is there; `at_once`: now, however long that takes.
  void follow(const std::shared_ptr<const Model>& model, SpheresLook look, bool at_once);
  /// Nothing is shown any more.
  void clear();

  ///@{
  /// Or none.
  [[nodiscard]] const Drawing* fine() const noexcept { return fine_ ? &*fine_ : nullptr; }
  [[nodiscard]] const Drawing* coarse() const noexcept { return coarse_ ? &*coarse_ : nullptr; }
  ///@}

 private:
  /// What is drawn.
  struct Key {
    Identity model = {};
    std::uint64_t revision = 0;
    SpheresLook look = SpheresLook::Surface;
    friend bool operator==(const Key&, const Key&) = default;
  };
  /// The coarse one last, where there is one.
  [[nodiscard]] static std::vector<std::shared_ptr<const Scene>> make(const sdk::Sphere& frame,
                                                                      const sdk::SphereMesh& shape, SpheresLook look,
                                                                      std::size_t coarse_cells);
  /// 0: no coarse one.
  [[nodiscard]] std::size_t coarse_cells_of(const sdk::SphereMesh& shape) const noexcept {
    return 2 * shape.triangles.size() > most_fluent_facets_ ? coarse_cells_ : 0;
  }
  void show(std::vector<Drawing> drawings, const Key& key);

  std::size_t most_at_once_, most_fluent_facets_, coarse_cells_;
  std::optional<Drawing> fine_, coarse_;
  Key key_, asked_;  // of the drawings; of those that are being made
};

}  // namespace armature::viewer
