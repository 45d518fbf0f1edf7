#include "tools/commands/render_sheet.h"

#include <algorithm>
#include <cmath>

#include "tools/sdk_call.h"
#include "viewer/render/renderer.h"

namespace armature::tools {
namespace {

using viewer::Layer;

constexpr int kSingleWidth = 1200, kSingleHeight = 900;  // of a picture with one cell
constexpr int kCellWidth = 720, kCellHeight = 640;       // of one of several
constexpr std::size_t kMostInARow = 4;

bool is_sphere_mesh(const NamedShape& shape) {
  return std::holds_alternative<sdk::SphereMesh>(shape.shape);
}

/// The ball around the box around shapes.
class Surroundings {
 public:
  void include(const sdk::Mesh& mesh) {
    for (const sdk::Triangle& triangle : mesh.triangles)
      for (const sdk::VertexId corner : triangle) box_.extend(mesh.position(corner));
  }
  void include(const sdk::SphereMesh& shape) {
    for (const sdk::Sphere& sphere : shape.spheres) {
      box_.extend((sphere.centre.array() - sphere.radius).matrix());
      box_.extend((sphere.centre.array() + sphere.radius).matrix());
    }
  }
  [[nodiscard]] sdk::Sphere ball() const {
    return box_.isEmpty() ? sdk::Sphere{} : sdk::Sphere{box_.center(), box_.diagonal().norm() / 2};
  }

 private:
  Eigen::AlignedBox3d box_;
};

std::uint8_t mixed(std::uint8_t a, std::uint8_t b, double share) {
  return static_cast<std::uint8_t>(std::lround(a + share * (b - a)));
}

/// The palette of a row of cells: the background goes on from row to row.
viewer::Palette palette_of_row(int row, const SheetGrid& grid, const SheetOptions& options) {
  viewer::Palette palette;
  const Colour top = options.background.value_or(palette.background_top);
  const Colour bottom = options.background.value_or(palette.background_bottom);
  for (std::size_t k = 0; k < 3; ++k) {
    palette.background_top[k] = mixed(top[k], bottom[k], static_cast<double>(row) / grid.rows);
    palette.background_bottom[k] = mixed(top[k], bottom[k], (row + 1.0) / grid.rows);
  }
  return palette;
}

void add(const NamedShape& named, const SheetCell::Item& item, const SheetOptions& options, viewer::Scene& scene) {
  if (const auto* mesh = std::get_if<sdk::Mesh>(&named.shape)) {
    scene.add(*mesh, {.layer = item.layer, .wireframe = options.wireframe});
  } else {
    using Shape = viewer::SphereMeshStyle::Shape;
    scene.add(std::get<sdk::SphereMesh>(named.shape),
              {.layer = item.layer, .shape = item.structure ? Shape::Structure : Shape::Surface});
  }
}

}  // namespace

std::vector<SheetCell> sheet_cells(std::span<const NamedShape> shapes, const SheetOptions& options) {
  const StructureView structure = options.structure;
  const bool any_sphere_mesh = std::any_of(shapes.begin(), shapes.end(), is_sphere_mesh);
  std::vector<SheetCell> cells;
  SheetCell surfaces, structures;
  const auto end_cells = [&] {
    for (SheetCell* cell : {&surfaces, &structures}) {
      if (!cell->items.empty()) cells.push_back(*cell);
      cell->items.clear();
    }
  };
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (!is_sphere_mesh(shapes[i])) {
      surfaces.items.push_back({i, options.overlay && any_sphere_mesh ? Layer::Glass : Layer::Solid});
    } else if (structure == StructureView::Instead) {
      surfaces.items.push_back({.shape = i, .structure = true});
    } else if (structure == StructureView::Inside) {
      surfaces.items.push_back({.shape = i, .structure = true});
      surfaces.items.push_back({i, Layer::Glass});
    } else {
      surfaces.items.push_back({i});
      if (structure == StructureView::Beside) structures.items.push_back({.shape = i, .structure = true});
    }
    if (!options.overlay) end_cells();
  }
  end_cells();
  return cells;
}

SheetGrid sheet_grid(std::size_t cells, const SheetOptions& options) {
  const std::size_t count = std::max<std::size_t>(cells, 1);
  const auto rows_of = [&](std::size_t columns) { return (count + columns - 1) / columns; };
  std::size_t columns = 1;
  SheetGrid grid;
  if (options.width > 0) {
    const auto side = [&](std::size_t c) {
      return std::min(static_cast<double>(options.width) / static_cast<double>(c),
                      static_cast<double>(options.height) / static_cast<double>(rows_of(c)));
    };
    for (std::size_t c = 2; c <= count; ++c)
      if (side(c) > side(columns)) columns = c;
    // Rounded up: no pixel is left without a cell.
    const auto divided = [](int length, std::size_t parts) { return (length - 1) / static_cast<int>(parts) + 1; };
    grid.width = divided(options.width, columns);
    grid.height = divided(options.height, rows_of(columns));
  } else {
    columns = count;
    if (count > kMostInARow) {
      columns = static_cast<std::size_t>(std::ceil(std::sqrt(count)));
      // One more where fewer places stay empty.
      if ((columns + 1) * rows_of(columns + 1) < columns * rows_of(columns)) ++columns;
    }
    const auto affordable = [](std::size_t parts) { return std::max(1, kMostPixelsASide / static_cast<int>(parts)); };
    grid.width = count == 1 ? kSingleWidth : std::min(kCellWidth, affordable(columns));
    grid.height = count == 1 ? kSingleHeight : std::min(kCellHeight, affordable(rows_of(columns)));
  }
  grid.columns = static_cast<int>(columns);
  grid.rows = static_cast<int>(rows_of(columns));
  return grid;
}

Expected<Picture> draw_sheet(std::span<const NamedShape> shapes, std::span<const SheetCell> cells,
                             const SheetGrid& grid, const SheetOptions& options) {
  auto renderer = ours(viewer::Renderer::create());
  if (!renderer) return tl::unexpected(renderer.error());

  const viewer::CameraFit nothing(options.view, static_cast<double>(grid.width) / grid.height);
  const auto include = [&](const SheetCell& cell, viewer::CameraFit& fit, Surroundings& around) {
    for (const SheetCell::Item& item : cell.items) {
      std::visit([&](const auto& shape) { fit.include(shape), around.include(shape); }, shapes[item.shape].shape);
    }
  };
  viewer::CameraFit fit_all = nothing;
  Surroundings around_all;
  for (const SheetCell& cell : cells) include(cell, fit_all, around_all);

  Picture picture(options.width > 0 ? options.width : grid.columns * grid.width,
                  options.width > 0 ? options.height : grid.rows * grid.height);
  for (int place = 0; place < grid.columns * grid.rows; ++place) {
    const int row = place / grid.columns;
    const int column = place % grid.columns;
    const bool used = static_cast<std::size_t>(place) < cells.size();
    viewer::CameraFit fit = fit_all;
    Surroundings around = around_all;
    if (options.fit_each && used) {
      fit = nothing;
      around = {};
      include(cells[static_cast<std::size_t>(place)], fit, around);
    }
    viewer::Scene scene(around.ball(), palette_of_row(row, grid, options));
    if (used) {
      for (const SheetCell::Item& item : cells[static_cast<std::size_t>(place)].items)
        add(shapes[item.shape], item, options, scene);
    }
    const auto image = ours(renderer->draw(scene, fit.camera(), grid.width, grid.height));
    if (!image) return tl::unexpected(image.error());
    picture.paste(column * grid.width, row * grid.height, image->width, image->rgb);
  }
  return picture;
}

}  // namespace armature::tools
