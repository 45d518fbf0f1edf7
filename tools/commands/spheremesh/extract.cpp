#include <chrono>
#include <cstdio>
#include <memory>
#include <string>

#include <armature/sdk/io/sphere_mesh_file.h>
#include <armature/sdk/io/write_mesh.h>
#include <armature/sdk/spheremesh/extract.h>

#include "tools/commands/spheremesh/spheremesh.h"
#include "tools/json_lines.h"
#include "tools/sdk_call.h"

namespace armature::tools {
namespace {

struct Arguments {
  std::string in, out;
  double tolerance_percent = 100 * sdk::ExtractOptions{}.tolerance;
  bool json = false;
};

Expected<void> run_extract(const Arguments& arguments) {
  SdkCall call;
  const auto shape = ours(sdk::read_sphere_mesh(arguments.in, call.task()));
  if (!shape) return tl::unexpected(shape.error());
  const auto start = std::chrono::steady_clock::now();
  const auto mesh = ours(sdk::extract_surface(*shape, {.tolerance = arguments.tolerance_percent / 100}, call.task()));
  if (!mesh) return fail(arguments.in + ": " + mesh.error().message);
  const double extract_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  if (auto written = ours(sdk::write_mesh(*mesh, arguments.out)); !written) return written;
  if (arguments.json)
    return write_json_line(
        stdout,
        {{"vertices", mesh->positions.size()}, {"faces", mesh->triangles.size()}, {"extract_ms", number(extract_ms)}});
  std::printf("%s: %zu vertices, %zu faces\n", arguments.out.c_str(), mesh->positions.size(), mesh->triangles.size());
  return {};
}

}  // namespace

void add_spheremesh_extract(CLI::App& spheremesh, Run& run) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      spheremesh.add_subcommand("extract", "Make a closed, manifold triangle mesh of a sphere-mesh's outer surface.");
  command->add_option("IN", arguments->in, "a sphere-mesh: .ma, or .ply with radius")->required();
  command->add_option("OUT", arguments->out, "the mesh: .ply, .obj or .off")->required();
  command
      ->add_option("--tolerance", arguments->tolerance_percent,
                   "how far mesh and surface may leave each other, in percent of the bounding box's diagonal")
      ->check(CLI::Range(0.001, 10.0))
      ->capture_default_str()
      ->type_name("PCT");
  command->add_flag("--json", arguments->json, "one JSON object: vertices, faces, extract_ms");
  command->footer(
      "Large triangles where the surface is flat, vertices on its creases; closed voids inside are left out, parts\n"
      "thinner than the tolerance are thickened to it.\n\n"
      "Example:\n  armature spheremesh extract cow.ma cow.ply --tolerance 0.2");
  command->callback([arguments, &run] { run = [arguments] { return run_extract(*arguments); }; });
}

}  // namespace armature::tools
