#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include <armature/sdk/hierarchy/hierarchy_file.h>
#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/io/sphere_mesh_file.h>

#include "tools/commands/choices.h"
#include "tools/commands/commands.h"
#include "tools/commands/render_sheet.h"
#include "tools/json_lines.h"
#include "tools/sdk_call.h"

namespace armature::tools {
namespace {

struct Angles {
  double azimuth_deg;
  double elevation_deg;
};
constexpr std::array<std::pair<const char*, Angles>, 7> kViews = {{{"front", {0, 0}},
                                                                   {"back", {180, 0}},
                                                                   {"left", {-90, 0}},
                                                                   {"right", {90, 0}},
                                                                   {"top", {0, 90}},
                                                                   {"bottom", {0, -90}},
                                                                   {"three-quarter", {35, 20}}}};
constexpr std::array<std::pair<const char*, viewer::Up>, 6> kUps = {{{"x", viewer::Up::X},
                                                                     {"y", viewer::Up::Y},
                                                                     {"z", viewer::Up::Z},
                                                                     {"-x", viewer::Up::MinusX},
                                                                     {"-y", viewer::Up::MinusY},
                                                                     {"-z", viewer::Up::MinusZ}}};
constexpr std::array<std::pair<const char*, StructureView>, 3> kStructures = {
    {{"beside", StructureView::Beside}, {"instead", StructureView::Instead}, {"inside", StructureView::Inside}}};
constexpr std::array<std::pair<const char*, bool>, 2> kFitsEach = {{{"all", false}, {"each", true}}};

struct Arguments {
  std::vector<std::string> files;
  std::string size, view = "three-quarter", up = "y", structure, fit = "all", background;
  std::optional<double> azimuth_deg, elevation_deg;
  std::vector<std::size_t> spheres = {45};
  bool overlay = false, wireframe = false, json = false;
};

std::string check_size(const std::string& text) {
  int width = 0;
  int height = 0;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%dx%d%c", &width, &height, &rest) == 2 && std::min(width, height) > 0 &&
      std::max(width, height) <= kMostPixelsASide)
    return {};
  return "expected WIDTHxHEIGHT, each from 1 to 8192, as in 1200x900";
}

std::optional<Colour> colour_named(const std::string& text) {
  if (text == "white") return Colour{255, 255, 255};
  if (text == "black") return Colour{0, 0, 0};
  unsigned rgb = 0;
  char rest = 0;
  if (text.size() != 7 || std::sscanf(text.c_str(), "#%6x%c", &rgb, &rest) != 1) return std::nullopt;
  return Colour{static_cast<std::uint8_t>(rgb >> 16), static_cast<std::uint8_t>(rgb >> 8 & 0xff),
                static_cast<std::uint8_t>(rgb & 0xff)};
}

std::string check_colour(const std::string& text) {
  return colour_named(text) ? std::string() : "expected white, black or #rrggbb";
}

SheetOptions sheet_options(const Arguments& arguments) {
  SheetOptions options;
  if (!arguments.size.empty()) std::sscanf(arguments.size.c_str(), "%dx%d", &options.width, &options.height);
  const Angles& view = choice_of(kViews, arguments.view);
  constexpr double kRadians = std::numbers::pi / 180;
  options.view.azimuth_rad = kRadians * arguments.azimuth_deg.value_or(view.azimuth_deg);
  options.view.elevation_rad = kRadians * arguments.elevation_deg.value_or(view.elevation_deg);
  options.view.up = choice_of(kUps, arguments.up);
  if (!arguments.structure.empty()) options.structure = choice_of(kStructures, arguments.structure);
  options.overlay = arguments.overlay;
  options.fit_each = choice_of(kFitsEach, arguments.fit);
  options.wireframe = arguments.wireframe;
  if (!arguments.background.empty()) options.background = colour_named(arguments.background);
  return options;
}

/// Adds what a file holds: one shape, or those levels of a hierarchy.
Expected<void> load(const std::string& file, std::span<const std::size_t> levels, const sdk::Task& task,
                    std::vector<NamedShape>& shapes) {
  const auto add = [&](auto shape) -> Expected<void> {
    if (!shape) return fail(shape.error().message);
    shapes.push_back({file, std::move(*shape)});
    return {};
  };
  if (std::filesystem::path(file).extension() == ".smh") {
    const auto hierarchy = ours(sdk::read_hierarchy(file, task));
    if (!hierarchy) return tl::unexpected(hierarchy.error());
    for (const std::size_t spheres : levels) {
      auto level = hierarchy->level(spheres);
      if (!level) return fail(file + ": " + level.error().message);
      if (auto added = add(std::move(level)); !added) return added;
    }
    return {};
  }
  if (sdk::holds_sphere_mesh(file)) return add(sdk::read_sphere_mesh(file, task));
  return add(sdk::read_mesh(file, {}, task));
}

Json described(const NamedShape& named, const SheetCell::Item& item) {
  Json result = {{"file", named.file}};
  if (const auto* mesh = std::get_if<sdk::Mesh>(&named.shape)) {
    result["kind"] = "mesh";
    result["vertices"] = mesh->positions.size();
    result["faces"] = mesh->triangles.size();
  } else {
    const auto& shape = std::get<sdk::SphereMesh>(named.shape);
    result["kind"] = item.structure ? "structure" : "sphere-mesh";
    result["spheres"] = shape.spheres.size();
    result["edges"] = shape.edges.size();
    result["triangles"] = shape.triangles.size();
  }
  result["layer"] = item.layer == viewer::Layer::Glass ? "glass" : "solid";
  return result;
}

Expected<void> render(const Arguments& arguments) {
  const SheetOptions options = sheet_options(arguments);
  const std::string& out = arguments.files.back();
  SdkCall call;
  std::vector<NamedShape> shapes;
  for (std::size_t i = 0; i + 1 < arguments.files.size(); ++i) {
    if (auto loaded = load(arguments.files[i], arguments.spheres, call.task(), shapes); !loaded) return loaded;
  }
  const std::vector<SheetCell> cells = sheet_cells(shapes, options);
  const SheetGrid grid = sheet_grid(cells.size(), options);
  const auto picture = draw_sheet(shapes, cells, grid, options);
  if (!picture) return tl::unexpected(picture.error());
  if (const auto written = picture->write_png(out); !written) return written;
  if (!arguments.json) return {};

  Json result = {{"picture", out},          {"width", picture->width()}, {"height", picture->height()},
                 {"columns", grid.columns}, {"rows", grid.rows},         {"cells", Json::array()}};
  for (const SheetCell& cell : cells) {
    Json items = Json::array();
    for (const SheetCell::Item& item : cell.items) items.push_back(described(shapes[item.shape], item));
    result["cells"].push_back(std::move(items));
  }
  return write_json_line(stdout, result);
}

}  // namespace

void add_render(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("render", "Draw meshes and sphere-meshes into a picture, without a display");
  command->add_option("--size", arguments->size, "Of the picture, in pixels [1200x900; several shapes: 720x640 each]")
      ->check(check_size)
      ->type_name("WxH");
  command->add_option("--view", arguments->view, "From where the shapes are seen")
      ->check(CLI::IsMember(names_of(kViews)))
      ->capture_default_str();
  command
      ->add_option("--azimuth", arguments->azimuth_deg, "Degrees about the up direction instead; 0 = front, 90 = right")
      ->check(CLI::Range(-360.0, 360.0));
  command->add_option("--elevation", arguments->elevation_deg, "Degrees above the horizon instead")
      ->check(CLI::Range(-90.0, 90.0));
  command->add_option("--up", arguments->up, "Which direction of the models is up")
      ->check(CLI::IsMember(names_of(kUps)))
      ->capture_default_str();
  command->add_flag("--overlay", arguments->overlay, "All shapes in one place; meshes as glass over sphere-meshes");
  command
      ->add_flag("--structure{beside}", arguments->structure,
                 "Show the spheres, edges and triangles that span sphere-meshes: beside their surfaces, or "
                 "--structure=instead, --structure=inside (a surface of glass)")
      ->check(CLI::IsMember(names_of(kStructures)));
  command->add_option("--spheres", arguments->spheres, "Which levels of a hierarchy (.smh)")
      ->delimiter(',')
      ->check(CLI::PositiveNumber)
      ->type_name("N[,N...]")
      ->capture_default_str();
  command->add_flag("--wireframe", arguments->wireframe, "Show the edges of meshes");
  command->add_option("--fit", arguments->fit, "One camera for all shapes, or one for each")
      ->check(CLI::IsMember(names_of(kFitsEach)))
      ->capture_default_str();
  command->add_option("--background", arguments->background, "white, black or #rrggbb [a light gradient]")
      ->check(check_colour)
      ->type_name("COLOUR");
  command->add_flag("--json", arguments->json, "Print what was drawn as one line of JSON");
  command
      ->add_option("FILES", arguments->files,
                   "Meshes, sphere-meshes (.ma, or .ply with radii) and hierarchies (.smh); then OUT.png")
      ->required()
      ->expected(2, 1'000'000);
  command->footer(
      "Spheres are red, what is interpolated along edges yellow, over triangles blue; meshes are grey or have their "
      "own\n"
      "colours, and purple is the inside of a mesh. Sphere-meshes are drawn exactly, not as triangles.\n\n"
      "Examples:\n"
      "  armature render elephant.off elephant.png\n"
      "  armature render elephant.off elephant.ma beside.png --structure\n"
      "  armature render elephant.smh levels.png --spheres 400,100,25\n"
      "  armature render elephant.off elephant.ma over.png --overlay --view left --size 1600x1200");
  command->callback([arguments, &run] {
    const std::string& out = arguments->files.back();
    if (out.size() < 5 || out.substr(out.size() - 4) != ".png")
      throw CLI::ValidationError("OUT", "expected a name that ends in .png, not " + out);
    run = [arguments] { return render(*arguments); };
  });
}

}  // namespace armature::tools
