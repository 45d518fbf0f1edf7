#include "tools/commands/render_sheet.h"

#include <gtest/gtest.h>

namespace armature::tools {
namespace {

using viewer::Layer;

std::vector<NamedShape> mesh_and_two_sphere_meshes() {
  return {{"a.off", sdk::Mesh{}}, {"b.ma", sdk::SphereMesh{}}, {"c.ma", sdk::SphereMesh{}}};
}

/// One letter an item: m mesh, s surface, t structure; capital where it is glass. A cell ends with a bar.
std::string layout(const SheetOptions& options) {
  const std::vector<NamedShape> shapes = mesh_and_two_sphere_meshes();
  std::string text;
  for (const SheetCell& cell : sheet_cells(shapes, options)) {
    for (const SheetCell::Item& item : cell.items) {
      const bool glass = item.layer == Layer::Glass;
      if (std::holds_alternative<sdk::Mesh>(shapes[item.shape].shape)) {
        text += glass ? 'M' : 'm';
      } else if (item.structure) {
        text += glass ? 'T' : 't';
      } else {
        text += glass ? 'S' : 's';
      }
      text += std::to_string(item.shape);
    }
    text += '|';
  }
  return text;
}

TEST(Sheet, GivesEachShapeACell) {
  EXPECT_EQ(layout({}), "m0|s1|s2|");
  EXPECT_EQ(layout({.structure = StructureView::Beside}), "m0|s1|t1|s2|t2|");
  EXPECT_EQ(layout({.structure = StructureView::Instead}), "m0|t1|t2|");
  EXPECT_EQ(layout({.structure = StructureView::Inside}), "m0|t1S1|t2S2|");
}

TEST(Sheet, LaysMeshesOverSphereMeshesAsGlass) {
  EXPECT_EQ(layout({.overlay = true}), "M0s1s2|");
  EXPECT_EQ(layout({.structure = StructureView::Beside, .overlay = true}), "M0s1s2|t1t2|");
  const std::vector<NamedShape> meshes = {{"a.off", sdk::Mesh{}}, {"b.off", sdk::Mesh{}}};
  const std::vector<SheetCell> cells = sheet_cells(meshes, {.overlay = true});
  ASSERT_EQ(cells.size(), 1U);
  for (const SheetCell::Item& item : cells[0].items)
    EXPECT_EQ(item.layer, Layer::Solid) << "there is nothing to be seen through them";
}

TEST(Sheet, HasRoomForEveryCellAndNoPixelWithoutOne) {
  for (std::size_t cells = 1; cells < 70; ++cells) {
    for (const auto& [width, height] : {std::pair{1200, 900}, {301, 100}, {50, 2000}, {1, 1}}) {
      const SheetGrid grid = sheet_grid(cells, {.width = width, .height = height});
      EXPECT_GE(static_cast<std::size_t>(grid.columns * grid.rows), cells);
      EXPECT_GE(grid.columns * grid.width, width);
      EXPECT_GE(grid.rows * grid.height, height);
      EXPECT_LT((grid.columns - 1) * (grid.width - 1), width) << "the last column is on the picture";
    }
    const SheetGrid free = sheet_grid(cells, {});
    EXPECT_GE(static_cast<std::size_t>(free.columns * free.rows), cells);
    EXPECT_LT(static_cast<std::size_t>(free.columns * (free.rows - 1)), cells) << "no row is empty";
  }
}

TEST(Sheet, KeepsThePictureOfManyCellsWithinBounds) {
  const SheetGrid grid = sheet_grid(5000, {});
  EXPECT_LE(grid.columns * grid.width, kMostPixelsASide);
  EXPECT_LE(grid.rows * grid.height, kMostPixelsASide);
}

TEST(Sheet, FollowsTheShapeOfThePicture) {
  EXPECT_EQ(sheet_grid(4, {.width = 1000, .height = 250}).columns, 4);
  EXPECT_EQ(sheet_grid(4, {.width = 250, .height = 1000}).columns, 1);
  EXPECT_EQ(sheet_grid(4, {.width = 500, .height = 500}).columns, 2);
  EXPECT_EQ(sheet_grid(3, {}).columns, 3);
}

}  // namespace
}  // namespace armature::tools
