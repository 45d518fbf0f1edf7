#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <armature/sdk/hierarchy/build.h>
#include <armature/sdk/hierarchy/hierarchy_file.h>
#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/io/sphere_mesh_file.h>
#include <armature/sdk/spheremesh/fewest_spheres.h>
#include <armature/sdk/spheremesh/refine.h>
#include <fmt/format.h>

#include "tools/commands/output_names.h"
#include "tools/commands/spheremesh/constraints.h"
#include "tools/commands/spheremesh/spheremesh.h"
#include "tools/elapsed.h"
#include "tools/json_lines.h"
#include "tools/peak_memory.h"
#include "tools/sdk_call.h"

namespace armature::tools {
namespace {

struct BuildOptions {
  std::string in, out, hierarchy_out, pins, labels;
  std::optional<std::size_t> spheres;
  std::optional<double> error_percent;
  std::optional<double> importance, regularise, compactness;
  double enrichment = 0;
  bool paper = false, keep_topology = false, painted = false;
  bool refine = false, inner = false, outer = false;
  bool json = false;
};

constexpr std::size_t kDefaultSpheres = 50;

Expected<sdk::HierarchyOptions> hierarchy_options(const BuildOptions& options, std::size_t vertices,
                                                  std::span<const sdk::Colour> colours) {
  sdk::HierarchyOptions result = options.paper ? sdk::HierarchyOptions::paper() : sdk::HierarchyOptions{};
  result.importance = options.importance.value_or(result.importance);
  result.regularise = options.regularise.value_or(result.regularise);
  if (options.compactness) result.compactness = options.compactness;
  result.enrichment = options.enrichment;
  result.keep_topology = options.keep_topology;
  if (!options.pins.empty()) {
    auto pins = read_pins(options.pins, vertices);
    if (!pins) return tl::unexpected(pins.error());
    result.pinned = std::move(*pins);
  }
  if (!options.labels.empty()) {
    auto labels = read_labels(options.labels, vertices);
    if (!labels) return tl::unexpected(labels.error());
    result.labels = std::move(*labels);
  }
  if (options.painted) {
    if (colours.empty())
      return fail(options.in +
                  ": --painted needs vertices with colours; it has none (--labels takes labels from a file)");
    result.labels = labels_of_paint(colours);
  }
  return result;
}

/// The options in use that forbid collapses, with a colon behind them; empty if there are none.
std::string limits(const BuildOptions& options) {
  std::vector<std::string_view> names;
  if (options.keep_topology) names.emplace_back("--keep-topology");
  if (!options.pins.empty()) names.emplace_back("--pin");
  if (!options.labels.empty()) names.emplace_back("--labels");
  if (options.painted) names.emplace_back("--painted");
  return names.empty() ? "" : fmt::format("{}: ", fmt::join(names, ", "));
}

/// The spheres of a level that stand for pinned vertices.
std::vector<sdk::SphereId> pinned_spheres(const sdk::Hierarchy& hierarchy, std::size_t spheres,
                                          const std::vector<sdk::PinnedSphere>& pins) {
  std::vector<sdk::SphereId> result;
  if (pins.empty()) return result;
  std::vector<bool> pinned(hierarchy.leaf_count(), false);
  for (const auto& pin : pins) pinned[pin.vertex.index()] = true;
  const auto nodes = hierarchy.nodes_of_level(spheres);
  for (std::size_t k = 0; k < nodes.size(); ++k)
    if (std::ranges::any_of(hierarchy.vertices(nodes[k]), [&](sdk::VertexId v) { return pinned[v.index()]; }))
      result.emplace_back(k);
  return result;
}

sdk::FitMode fit_mode(const BuildOptions& options) {
  if (options.inner) return sdk::FitMode::Inner;
  return options.outer ? sdk::FitMode::Outer : sdk::FitMode::Best;
}

Expected<void> build(const BuildOptions& options) {
  SdkCall call;
  reset_peak_memory();
  const auto start = std::chrono::steady_clock::now();
  const auto shape = ours(sdk::read_mesh_or_points(options.in, {}, call.task()));
  if (!shape) return tl::unexpected(shape.error());
  const auto* const mesh = std::get_if<sdk::Mesh>(&*shape);
  const auto* const points = std::get_if<sdk::PointSet>(&*shape);
  const double read_ms = milliseconds_since(start);

  const std::size_t vertices = mesh != nullptr ? mesh->positions.size() : points->positions.size();
  if (mesh == nullptr && (options.refine || options.inner || options.outer || options.error_percent))
    return fail(fmt::format("{}: has {} points and no faces; --refine, --inner, --outer and --error need a mesh",
                            options.in, vertices));
  std::size_t spheres = options.spheres.value_or(std::min(kDefaultSpheres, vertices));
  if (spheres > vertices) {
    return fail(fmt::format("{}: {} spheres from {} vertices; --spheres takes at most as many as there are vertices",
                            options.in, spheres, vertices));
  }
  auto settings = hierarchy_options(options, vertices, mesh != nullptr ? mesh->vertex_colours : points->colours);
  if (!settings) return tl::unexpected(settings.error());
  if (mesh == nullptr && settings->importance > 0)
    return fail(fmt::format("{}: has {} points and no faces to tell curvature by; {}", options.in, vertices,
                            options.importance ? "leave --importance out" : "add --importance 0 to --paper"));
  if (options.hierarchy_out.empty() && !options.error_percent) settings->stop_at = spheres;
  const auto built =
      ours(std::visit([&](const auto& known) { return sdk::build_hierarchy(known, *settings, call.task()); }, *shape));
  if (!built) return fail(options.in + ": " + built.error().message);
  const sdk::Hierarchy& hierarchy = built->hierarchy;
  if (!options.spheres) spheres = std::max(spheres, hierarchy.min_spheres());
  if (spheres < hierarchy.min_spheres()) {
    return fail(fmt::format("{}: {}no fewer than {} spheres are left; {} were asked for", options.in, limits(options),
                            hierarchy.min_spheres(), spheres));
  }
  if (!options.hierarchy_out.empty()) {
    auto written = ours(sdk::write_hierarchy(hierarchy, options.hierarchy_out));
    if (!written) return written;
  }

  double refine_ms = 0;
  const auto approximate = [&](std::size_t count) -> sdk::Expected<sdk::SphereMesh> {
    auto level = hierarchy.level(count);
    const bool refines = options.refine || options.inner || options.outer;
    if (!level || !refines) return level;
    const auto before = std::chrono::steady_clock::now();
    sdk::RefineOptions fit{.mode = fit_mode(options), .pinned = pinned_spheres(hierarchy, count, settings->pinned)};
    // Spheres that are split and joined anew would not know their label.
    if (!settings->labels.empty()) fit.rounds = 0;
    auto refined = sdk::refine(*mesh, *level, fit, call.task());
    refine_ms += milliseconds_since(before);
    return refined;
  };
  const auto result = ours(options.error_percent ? sdk::fewest_spheres(*mesh,
                                                                       {.percent = *options.error_percent,
                                                                        .least = hierarchy.min_spheres(),
                                                                        .most = hierarchy.leaf_count()},
                                                                       approximate, call.task())
                                                 : approximate(spheres));
  if (!result) return fail(options.in + ": " + result.error().message);

  if (auto written = ours(sdk::write_sphere_mesh(*result, options.out, call.task())); !written) return written;
  const sdk::BuildStatistics& took = built->statistics;
  if (options.json) {
    return write_json_line(stdout, {{"spheres", result->spheres.size()},
                                    {"edges", result->edges.size()},
                                    {"triangles", result->triangles.size()},
                                    {"read_ms", number(read_ms)},
                                    {"init_ms", number(took.init_ms)},
                                    {"decimate_ms", number(took.decimate_ms)},
                                    {"refine_ms", number(refine_ms)},
                                    {"collapses", took.collapses},
                                    {"compactness", number(took.compactness)},
                                    {"peak_mb", number(peak_memory_mb())}});
  }
  std::printf("%s\n", fmt::format("{}: {} spheres, {} wire edges, {} triangles", options.out, result->spheres.size(),
                                  result->edges.size(), result->triangles.size())
                          .c_str());
  return {};
}

}  // namespace

void add_spheremesh_build(CLI::App& spheremesh, Run& run) {
  auto options = std::make_shared<BuildOptions>();
  CLI::App* command =
      spheremesh.add_subcommand("build", "Approximate a mesh, or points, by a few interpolated spheres.");
  command->add_option("IN", options->in, "a triangle mesh, or points with normals (PLY, OBJ, NOFF, XYZ)")->required();
  command->add_option("OUT", options->out, "the sphere-mesh: .ma, .ply (with radius) or .urdf (spheres alone)")
      ->required()
      ->check(wrong_sphere_mesh_name);
  command->add_option("--spheres", options->spheres, "how many (default: 50)")->check(CLI::PositiveNumber);
  command
      ->add_option("--error", options->error_percent,
                   "the fewest that keep the mean distance from the mesh to the spheres below so many percent of the "
                   "bounding box's diagonal")
      ->check(CLI::PositiveNumber)
      ->type_name("PCT")
      ->excludes("--spheres");
  command
      ->add_option("--importance", options->importance,
                   "how much more curved places count: 0 fits (default), 1 abstracts")
      ->check(CLI::NonNegativeNumber);
  CLI::Option* enrich =
      command
          ->add_option("--enrich", options->enrichment,
                       "join vertices through the solid that are nearer than this part of the bounding box's diagonal")
          ->check(CLI::NonNegativeNumber)
          ->capture_default_str();
  command->add_option("--regularise", options->regularise, "pull towards the middle of the region (default: 1e-4)")
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option(
          "--compactness", options->compactness,
          "how much it counts how far points lie from their sphere: 0.01 cuts straight tubes across, as bends want it, "
          "not along (default: 0.01 for meshes that would be cut along in large part, else 0)")
      ->check(CLI::NonNegativeNumber);
  command->add_flag("--keep-topology", options->keep_topology, "only collapses that keep the topology of the mesh")
      ->excludes(enrich);
  command
      ->add_option("--pin", options->pins,
                   "spheres that stay: a text file with a line each, VERTEX (it stays where it is, with radius 0) or "
                   "VERTEX X Y Z RADIUS; vertices count from 0 in the order of IN")
      ->type_name("FILE");
  CLI::Option* labels =
      command
          ->add_option(
              "--labels", options->labels,
              "never join vertices with different labels: a text file with a whole number for each vertex of "
              "IN, a line each. Refining then keeps the connectivity; --inner may still drop edges and triangles")
          ->type_name("FILE");
  command->add_flag("--painted", options->painted, "take the colours of IN's vertices as labels, as --labels does")
      ->excludes(labels);
  command->add_flag(
      "--paper", options->paper,
      "the settings of the thesis: importance 1, regularise 0; collapses ranked by the error of the "
      "sphere that they make, not "
      "by what they add; radii bounded by 3/4 of a width, not 1.2, along the axes of the file, not of the shape");
  command->add_flag("--refine", options->refine, "then fit what is interpolated between the spheres, both ways");
  CLI::Option* inner = command->add_flag("--inner", options->inner,
                                         "refine so that the spheres stay within the mesh, which must be closed");
  command->add_flag("--outer", options->outer, "refine so that the spheres enclose the mesh, for collision tests")
      ->excludes(inner);
  command->add_option("--hierarchy", options->hierarchy_out, "also store every level, for `spheremesh level`")
      ->type_name("OUT.smh");
  command->add_flag("--json", options->json, "one JSON object: counts, times in milliseconds, memory");
  command->footer(
      "Lengths do not matter: what is relative is relative to the diagonal of the mesh's bounding box.\n\n"
      "Examples:\n"
      "  armature spheremesh build cow.obj cow.ma --spheres 60 --refine\n"
      "  armature spheremesh build cow.obj cow.urdf --error 0.5 --outer\n"
      "  armature spheremesh build cow.obj cow.ma --hierarchy cow.smh\n"
      "  armature spheremesh build cow.ply cow.ma --painted --pin hooves.txt");
  command->callback([options, &run] { run = [options] { return build(*options); }; });
}

}  // namespace armature::tools
