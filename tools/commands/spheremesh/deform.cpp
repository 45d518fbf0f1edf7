#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>

#include <armature/sdk/deformation/deform.h>
#include <armature/sdk/deformation/sphere_counterparts.h>
#include <armature/sdk/io/write_mesh.h>
#include <fmt/format.h>

#include "tools/commands/choices.h"
#include "tools/commands/output_names.h"
#include "tools/commands/spheremesh/inputs.h"
#include "tools/commands/spheremesh/sphere_moves.h"
#include "tools/commands/spheremesh/spheremesh.h"
#include "tools/elapsed.h"
#include "tools/json_lines.h"
#include "tools/sdk_call.h"

namespace armature::tools {
namespace {

constexpr std::array<std::pair<const char*, sdk::WeightSource>, 2> kWeights = {
    {{"clusters", sdk::WeightSource::Clusters}, {"primitives", sdk::WeightSource::ClosestPrimitive}}};
constexpr std::array<std::pair<const char*, sdk::Blend>, 2> kBlends = {
    {{"dual-quaternions", sdk::Blend::DualQuaternions}, {"linear", sdk::Blend::Linear}}};

struct Arguments {
  std::string mesh, hierarchy, moves, out;
  std::size_t level = 0;
  std::string weights = "clusters", blend = "dual-quaternions";
  double reach = sdk::HeatOptions{}.reach;
  bool free_volume = false;
  bool similar = false;
  sdk::SwingOptions swing;
  bool json = false;
};

Expected<void> run_deform(const Arguments& arguments) {
  SdkCall call;
  const auto read = read_mesh_with_hierarchy(arguments.mesh, arguments.hierarchy, call.task());
  if (!read) return tl::unexpected(read.error());
  const auto& [mesh, hierarchy] = *read;
  if (arguments.level < hierarchy.min_spheres() || arguments.level > hierarchy.leaf_count())
    return fail(fmt::format("--level {}: {} has levels of {} to {} spheres; choose one of them", arguments.level,
                            arguments.hierarchy, hierarchy.min_spheres(), hierarchy.leaf_count()));
  const auto given = read_sphere_moves(arguments.moves, arguments.level);
  if (!given) return tl::unexpected(given.error());
  const auto start = std::chrono::steady_clock::now();
  const auto moves =
      arguments.similar ? sdk::with_counterparts(mesh, hierarchy, arguments.level, *given, arguments.swing, call.task())
                        : *given;
  if (!moves && moves.error().kind == sdk::ErrorKind::Cancelled) return fail(moves.error().message);
  if (!moves) return fail(arguments.moves + ": " + moves.error().message);
  const sdk::DeformOptions options{.heat = {.reach = arguments.reach},
                                   .weights = choice_of(kWeights, arguments.weights),
                                   .blend = choice_of(kBlends, arguments.blend),
                                   .keep_volume = !arguments.free_volume};
  const auto deformed = sdk::deform(mesh, hierarchy, arguments.level, *moves, options, call.task());
  if (!deformed) return fail(arguments.moves + ": " + deformed.error().message);
  const double deform_ms = milliseconds_since(start);
  if (auto written = ours(sdk::write_mesh(*deformed, arguments.out, {}, call.task())); !written) return written;

  double most = 0;
  std::size_t moved = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const double distance = (deformed->positions[v] - mesh.positions[v]).norm();
    most = std::max(most, distance);
    if (distance > 0) ++moved;
  }
  if (arguments.json)
    return write_json_line(stdout, {{"vertices", mesh.positions.size()},
                                    {"faces", mesh.triangles.size()},
                                    {"spheres", arguments.level},
                                    {"moves", given->size()},
                                    {"counterparts", moves->size() - given->size()},
                                    {"moved_vertices", moved},
                                    {"largest_displacement", number(most)},
                                    {"deform_ms", number(deform_ms)}});
  fmt::print("{}: {} of {} vertices moved, {:.6g} at most{}\n", arguments.out, moved, mesh.positions.size(), most,
             arguments.similar ? fmt::format("; {} counterparts", moves->size() - given->size()) : "");
  return {};
}

}  // namespace

void add_spheremesh_deform(CLI::App& spheremesh, Run& run) {
  auto arguments = std::make_shared<Arguments>();
  const CLI::Validator finite(
      [](const std::string& text) {
        double value = 0;
        return CLI::detail::lexical_cast(text, value) && std::isfinite(value) ? ""
                                                                              : text + ": expected a finite number";
      },
      "FLOAT");
  CLI::App* command = spheremesh.add_subcommand("deform", "Move spheres of a level, and the mesh follows.");
  command->add_option("MESH", arguments->mesh, "the mesh that the hierarchy was built from")->required();
  command->add_option("HIERARCHY", arguments->hierarchy, "its hierarchy (.smh)")->required()->type_name("H.smh");
  command->add_option("MOVES", arguments->moves, "what to do to which spheres, as JSON (below)")
      ->required()
      ->type_name("MOVES.json");
  command->add_option("OUT", arguments->out, "the deformed mesh: .ply, .obj or .off; vertices keep their order")
      ->required()
      ->check(wrong_mesh_name);
  command->add_option("--level", arguments->level, "how many spheres the level has")
      ->required()
      ->check(CLI::Range(std::size_t{0}, std::size_t{1} << 31))
      ->type_name("N");
  command
      ->add_option("--weights", arguments->weights,
                   "where weights start: from all vertices that a sphere stands for, or from the nearest sphere, edge "
                   "or triangle, shared along it")
      ->check(CLI::IsMember(names_of(kWeights)))
      ->capture_default_str();
  command->add_option("--blend", arguments->blend, "how the motions of spheres are blended")
      ->check(CLI::IsMember(names_of(kBlends)))
      ->capture_default_str();
  command->add_flag("--free-volume", arguments->free_volume,
                    "let the volume of a closed mesh change where spheres only turn, as blending does");
  command
      ->add_option("--reach", arguments->reach,
                   "how far spheres blend into one another: weights fall by a factor e over so much of the diagonal")
      ->check(CLI::Range(1e-4, 10.0))
      ->capture_default_str();
  CLI::Option* similar = command->add_flag(
      "--similar", arguments->similar,
      "move counterparts of the spheres likewise, in their own frames: best in hierarchies of `armature decimate`");
  command
      ->add_option("--misfit", arguments->swing.counterparts.most_misfit,
                   "how far surfaces about counterparts lie apart at most, as a part of their size")
      ->check(CLI::Range(1e-6, 10.0))
      ->capture_default_str()
      ->needs(similar);
  command
      ->add_option("--time", arguments->swing.time,
                   "when, in periods, if the moves swing to and fro: 0 is at rest but for radii, which "
                   "are set throughout; 0.25 all of them")
      ->check(finite)
      ->capture_default_str()
      ->needs(similar);
  command
      ->add_option("--phase", arguments->swing.phases,
                   "by how many periods counterparts lag behind, the best first and over again if they are more")
      ->check(finite)
      ->delimiter(',')
      ->needs(similar);
  command->add_flag("--json", arguments->json,
                    "one JSON object: vertices, faces, spheres, moves, counterparts, moved_vertices, "
                    "largest_displacement, deform_ms");
  command->footer(
      "Moves, one after the other; [] moves nothing:\n"
      "  "
      "[{\"spheres\":[i,...],\"translate\":[x,y,z],\"rotate\":[ax,ay,az],\"about\":[x,y,z],\"scale\":s,\"radius\":r}, "
      "...]\n"
      "Spheres count from 0 as `spheremesh level --spheres N` writes them; an edge or a triangle is its two or three.\n"
      "All else may be left out: rotate is the axis times the angle in radians, about the mean of the spheres'\n"
      "centres unless `about` says where; scale is a factor; radius is what radii become, and the shape swells there.\n"
      "Lengths are in the mesh's units.\n\n"
      "Examples:\n"
      "  armature spheremesh build cow.obj cow.ma --spheres 40 --hierarchy cow.smh\n"
      "  echo '[{\"spheres\":[3],\"translate\":[0,0.1,0]},{\"spheres\":[7],\"radius\":0.2}]' > moves.json\n"
      "  armature spheremesh deform cow.obj cow.smh moves.json moved.ply --level 40\n"
      "  armature decimate cow.obj cow.ma --target 40 --hierarchy alike.smh\n"
      "  armature spheremesh deform cow.obj alike.smh moves.json walks.ply --level 40 --similar --phase 0.5");
  command->callback([arguments, &run] { run = [arguments] { return run_deform(*arguments); }; });
}

}  // namespace armature::tools
