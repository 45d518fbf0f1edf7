// What the colours of a mesh say.
#include "viewer/session/maps.h"

#include <memory>
#include <utility>

#include <gtest/gtest.h>

namespace armature::viewer {
namespace {

TEST(Models, ShowTheirMatchesOverAMap) {
  Model model;
  model.values = {0, 0.5F, 1, 0};
  model.mesh = std::make_shared<const MeshShape>(
      sdk::Mesh{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
                .triangles = {{sdk::VertexId(0), sdk::VertexId(1), sdk::VertexId(2)},
                              {sdk::VertexId(2), sdk::VertexId(1), sdk::VertexId(3)}}});
  const auto colours = [&](MapKind map) {
    return corner_colours(model.mesh->mesh, model.mesh->surface.adjacency, paint_of(model, map), {200, 200, 200});
  };
  const auto plain = colours(MapKind::None), mapped = colours(MapKind::Curvature);
  const sdk::Match match{.faces = {sdk::FaceId(1)}, .score = 1};
  model.selecting.expansion = sdk::Expansion({sdk::FaceId(0)}, {{.match = match, .histogram = {1, 0}}}, {});
  model.selecting.shown = 1;
  for (const auto& [map, before] : {std::pair{MapKind::None, plain}, std::pair{MapKind::Curvature, mapped}}) {
    const auto after = colours(map);
    EXPECT_EQ(after[0], before[0]);
    EXPECT_NE(after[1], before[1]);
  }
  // The map is still to be seen.
  EXPECT_NE(colours(MapKind::Curvature)[1][0], colours(MapKind::Curvature)[1][1]);
}

}  // namespace
}  // namespace armature::viewer
