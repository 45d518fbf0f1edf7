#include "tools/commands/decimate/decimate.h"

#include <array>
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <variant>

#include <armature/sdk/decimation/similar_decimation.h>
#include <armature/sdk/hierarchy/hierarchy_file.h>
#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/io/sphere_mesh_file.h>
#include <armature/sdk/io/write_mesh.h>
#include <fmt/format.h>

#include "tools/commands/choices.h"
#include "tools/elapsed.h"
#include "tools/json_lines.h"
#include "tools/sdk_call.h"

namespace armature::tools {
namespace {

constexpr std::array<std::pair<const char*, sdk::RegionDescriptor>, 5> kDescriptors = {
    {{"gls-histogram", sdk::RegionDescriptor::GlsHistograms},
     {"gls-mean", sdk::RegionDescriptor::GlsMean},
     {"quadric", sdk::RegionDescriptor::Quadric},
     {"gls-scaled", sdk::RegionDescriptor::ScaledGlsHistograms},
     {"gls-merged", sdk::RegionDescriptor::MergedGls}}};

struct Arguments {
  std::string in, out, hierarchy_out;
  std::size_t target = 0;
  sdk::SimilarityOptions similarity;
  std::string descriptor = "gls-histogram";
  std::string kind = "spheres";
  bool json = false;
};

/// What a decimation came to.
struct Outcome {
  std::size_t levels = 0, collapses = 0;
  double descriptor_ms = 0, counterparts_ms = 0, decimate_ms = 0;
  std::string what;  ///< for people
};

Expected<Outcome> decimate_spheres(const Arguments& arguments, const sdk::MeshOrPoints& shape, const sdk::Task& task) {
  sdk::HierarchyOptions options;
  if (arguments.hierarchy_out.empty()) options.stop_at = arguments.target;
  const auto similar = ours(std::visit(
      [&](const auto& known) { return sdk::build_similar_hierarchy(known, options, arguments.similarity, task); },
      shape));
  if (!similar) return fail(arguments.in + ": " + similar.error().message);
  const sdk::Hierarchy& hierarchy = similar->build.hierarchy;
  if (!arguments.hierarchy_out.empty())
    if (auto written = ours(sdk::write_hierarchy(hierarchy, arguments.hierarchy_out)); !written)
      return tl::unexpected(written.error());
  const auto level = ours(hierarchy.level(arguments.target));
  if (!level) return fail(arguments.in + ": " + level.error().message);
  if (auto written = ours(sdk::write_sphere_mesh(*level, arguments.out, task)); !written)
    return tl::unexpected(written.error());
  const auto& took = similar->build.statistics;
  return Outcome{.levels = hierarchy.steps_to(arguments.target),
                 .collapses = hierarchy.leaf_count() - arguments.target,
                 .descriptor_ms = similar->descriptor_ms,
                 .counterparts_ms = similar->counterparts_ms,
                 .decimate_ms = took.init_ms + took.decimate_ms,
                 .what = fmt::format("{} spheres, {} wire edges, {} triangles", level->spheres.size(),
                                     level->edges.size(), level->triangles.size())};
}

Expected<Outcome> decimate_mesh(const Arguments& arguments, const sdk::MeshOrPoints& shape, const sdk::Task& task) {
  if (const auto* points = std::get_if<sdk::PointSet>(&shape))
    return fail(fmt::format("{}: has {} points and no faces; --kind mesh needs a mesh, --kind spheres takes points",
                            arguments.in, points->positions.size()));
  const auto& mesh = std::get<sdk::Mesh>(shape);
  const auto similar =
      ours(sdk::decimate_similar_mesh(mesh, {.vertices = arguments.target}, arguments.similarity, task));
  if (!similar) return fail(arguments.in + ": " + similar.error().message);
  const sdk::Mesh& coarse = similar->decimated.mesh;
  if (auto written = ours(sdk::write_mesh(coarse, arguments.out)); !written) return tl::unexpected(written.error());
  return Outcome{.levels = similar->steps,
                 .collapses = mesh.positions.size() - coarse.positions.size(),
                 .descriptor_ms = similar->descriptor_ms,
                 .counterparts_ms = similar->counterparts_ms,
                 .decimate_ms = similar->decimate_ms,
                 .what = fmt::format("{} vertices, {} faces", coarse.positions.size(), coarse.triangles.size())};
}

constexpr std::array<
    std::pair<const char*, Expected<Outcome> (*)(const Arguments&, const sdk::MeshOrPoints&, const sdk::Task&)>, 2>
    kKinds = {{{"spheres", decimate_spheres}, {"mesh", decimate_mesh}}};

Expected<void> run_decimate(Arguments arguments) {
  arguments.similarity.descriptor = choice_of(kDescriptors, arguments.descriptor);
  const bool spheres = arguments.kind == "spheres";
  if (spheres && !sdk::sphere_mesh_format_of(arguments.out))
    return fail(arguments.out + ": expected a name that ends in .ma, .ply or .urdf; --kind mesh writes meshes");
  if (!spheres && !arguments.hierarchy_out.empty())
    return fail("--hierarchy: holds spheres; leave it out with --kind mesh");
  SdkCall call;
  const auto start = std::chrono::steady_clock::now();
  const auto shape = ours(sdk::read_mesh_or_points(arguments.in, {}, call.task()));
  if (!shape) return tl::unexpected(shape.error());
  const double read_ms = milliseconds_since(start);
  const std::size_t vertices = std::visit([](const auto& known) { return known.positions.size(); }, *shape);
  if (arguments.target > vertices)
    return fail(fmt::format("{}: has {} {}; --target takes at most as many, {} were asked for", arguments.in, vertices,
                            std::holds_alternative<sdk::Mesh>(*shape) ? "vertices" : "points", arguments.target));
  const auto outcome = choice_of(kKinds, arguments.kind)(arguments, *shape, call.task());
  if (!outcome) return tl::unexpected(outcome.error());
  if (arguments.json)
    return write_json_line(stdout, {{"levels", outcome->levels},
                                    {"collapses", outcome->collapses},
                                    {"descriptor_ms", number(outcome->descriptor_ms)},
                                    {"counterparts_ms", number(outcome->counterparts_ms)},
                                    {"decimate_ms", number(outcome->decimate_ms)},
                                    {"read_ms", number(read_ms)}});
  fmt::print("{}: {}; {} collapses in {} steps\n", arguments.out, outcome->what, outcome->collapses, outcome->levels);
  return {};
}

}  // namespace

void add_decimate(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("decimate", "Simplify a mesh, or points with normals, like regions together");
  command->add_option("IN", arguments->in, "a triangle mesh, or points with normals (PLY, OBJ, NOFF, XYZ)")->required();
  command->add_option("OUT", arguments->out, "spheres as .ma, .ply or .urdf; with --kind mesh: OBJ, OFF or PLY")
      ->required();
  command->add_option("--target", arguments->target, "how many spheres, or vertices, to reach")
      ->required()
      ->check(CLI::PositiveNumber)
      ->type_name("N");
  CLI::Option* similar =
      command
          ->add_option("--similar", arguments->similarity.threshold,
                       "how unlike regions may be that are simplified together: from 0, nothing together, to 1")
          ->check(CLI::NonNegativeNumber)
          ->capture_default_str()
          ->type_name("EPS");
  command
      ->add_flag("--adaptive", arguments->similarity.adaptive,
                 "instead, in each step as unlike as the first gap in the ranking tells")
      ->excludes(similar);
  command->add_option("--descriptor", arguments->descriptor, "what regions are compared by")
      ->check(CLI::IsMember(names_of(kDescriptors)))
      ->capture_default_str();
  command->add_option("--kind", arguments->kind, "spheres, or a mesh by the quadric error metric")
      ->check(CLI::IsMember(names_of(kKinds)))
      ->capture_default_str();
  command->add_option("--hierarchy", arguments->hierarchy_out, "also store every level, with its steps")
      ->type_name("OUT.smh");
  command->add_flag("--json", arguments->json, "one JSON object: levels (steps), collapses, times in milliseconds");
  command->footer(
      "Each step collapses the cheapest edge and all edges whose regions are like its own and far enough apart, so\n"
      "that what is alike stays alike, and a hierarchy has fewer steps to walk through. --similar 0 is the plain\n"
      "decimation of `armature spheremesh build`, bit by bit. Points are joined to their neighbours for it.\n\n"
      "Examples:\n"
      "  armature decimate cow.obj cow.ma --target 60\n"
      "  armature decimate cow.obj cow.ma --target 60 --adaptive --hierarchy cow.smh\n"
      "  armature decimate scan.xyz scan.ma --target 60\n"
      "  armature decimate cow.obj coarse.obj --target 2000 --kind mesh");
  command->callback([arguments, &run] { run = [arguments] { return run_decimate(*arguments); }; });
}

}  // namespace armature::tools
