#pragma once

#include <vector>

#include "viewer/session/session.h"

namespace armature::viewer {

/// The values of a map by vertex, in [0, 1]. `reference` is what the similarity map is about.
[[nodiscard]] sdk::Expected<std::vector<float>> compute_map(const MeshShape& shape, MapKind kind,
                                                            const std::vector<sdk::FaceId>& reference,
                                                            const sdk::Task& task);

/// What a mesh's colours say; a copy, which jobs can look at.
struct MeshPaint {
  MapKind map = MapKind::None;
  std::vector<float> values = {};  ///< of the map, by vertex; or empty
  std::vector<sdk::FaceId> selected = {}, drawn = {};
  std::vector<sdk::Match> like = {};  ///< the matches that are shown
};
[[nodiscard]] MeshPaint paint_of(const Model& model, MapKind map);

/// The colours of a mesh's faces or vertices, as they are shown: its own, those of a map, and over them what is
/// selected and what is like it. Returns a mesh's worth of colours for its corners.
[[nodiscard]] std::vector<std::array<sdk::Colour, 3>> corner_colours(const sdk::Mesh& mesh,
                                                                     const sdk::Adjacency& adjacency,
                                                                     const MeshPaint& paint, const sdk::Colour& plain);

}  // namespace armature::viewer
