#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/spheremesh/sphere_mesh.h>

#include "firmware_host/error.h"
#include "tools/picture.h"
#include "viewer/scene/camera.h"
#include "viewer/scene/scene.h"

namespace armature::tools {

/// The longest side of a picture, in pixels.
inline constexpr int kMostPixelsASide = 8192;

/// A shape to be drawn, and the file it came from.
struct NamedShape {
  std::string file;
  std::variant<sdk::Mesh, sdk::SphereMesh> shape;
};

/// Where the structure of sphere-meshes is drawn: their spheres, edges and triangles, thin.
enum class StructureView : std::uint8_t {
  None,
  Beside,   ///< in a cell of its own, after that of the surface
  Instead,  ///< of the surface
  Inside,   ///< within a surface of glass
};

/// How shapes are laid out on a picture and drawn.
struct SheetOptions {
  int width = 0;  ///< in pixels, with `height`; 0: by the number of cells
  int height = 0;
  viewer::View view = {};
  StructureView structure = StructureView::None;
  bool overlay = false;    ///< all shapes in one cell; meshes as glass over sphere-meshes
  bool fit_each = false;   ///< a camera for each cell instead of one for all
  bool wireframe = false;  ///< edges of meshes
  std::optional<Colour> background = {};
};

/// What one cell of a sheet shows.
struct SheetCell {
  struct Item {
    std::size_t shape;  // place in the list of shapes
    viewer::Layer layer = viewer::Layer::Solid;
    bool structure = false;
  };
  std::vector<Item> items;
};

/// Cells in rows, each `width` x `height` pixels.
struct SheetGrid {
  int columns = 1;
  int rows = 1;
  int width = 0;
  int height = 0;
};

/// Which cells the shapes make.
[[nodiscard]] std::vector<SheetCell> sheet_cells(std::span<const NamedShape> shapes, const SheetOptions& options);

/// How so many cells are laid out: those of a picture of a given size as large and square as can be, else of a
/// comfortable size. At least one pixel each.
[[nodiscard]] SheetGrid sheet_grid(std::size_t cells, const SheetOptions& options);

/// Draws the cells. Fails where OpenGL is not available.
[[nodiscard]] Expected<Picture> draw_sheet(std::span<const NamedShape> shapes, std::span<const SheetCell> cells,
                                           const SheetGrid& grid, const SheetOptions& options);

}  // namespace armature::tools
