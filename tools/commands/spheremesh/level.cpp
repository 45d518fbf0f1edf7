#include <cstdio>
#include <memory>
#include <string>

#include <armature/sdk/hierarchy/hierarchy_file.h>
#include <armature/sdk/io/sphere_mesh_file.h>

#include "tools/commands/output_names.h"
#include "tools/commands/spheremesh/inputs.h"
#include "tools/commands/spheremesh/spheremesh.h"
#include "tools/json_lines.h"
#include "tools/sdk_call.h"

namespace armature::tools {
namespace {

struct Arguments {
  std::string hierarchy, out;
  std::size_t spheres = 0;
  bool json = false;
};

Expected<void> run_level(const Arguments& arguments) {
  SdkCall call;
  const auto hierarchy = ours(sdk::read_hierarchy(arguments.hierarchy, call.task()));
  if (!hierarchy) return tl::unexpected(hierarchy.error());
  const auto level = hierarchy->level(arguments.spheres);
  if (!level) return tl::unexpected(Error{arguments.hierarchy + ": " + level.error().message});
  if (auto written = ours(sdk::write_sphere_mesh(*level, arguments.out, call.task())); !written) return written;
  if (arguments.json)
    return write_json_line(
        stdout,
        {{"spheres", level->spheres.size()}, {"edges", level->edges.size()}, {"triangles", level->triangles.size()}});
  std::printf("%zu spheres, %zu edges, %zu triangles\n", level->spheres.size(), level->edges.size(),
              level->triangles.size());
  return {};
}

}  // namespace

void add_spheremesh_level(CLI::App& spheremesh, Run& run) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      spheremesh.add_subcommand("level", "Take one level out of a hierarchy: the sphere-mesh with so many spheres.");
  command
      ->add_option("HIERARCHY", arguments->hierarchy, "a hierarchy (.smh), as `spheremesh build --hierarchy` stores it")
      ->required();
  command->add_option("OUT", arguments->out, "the sphere-mesh to write (.ma, .ply, .urdf)")
      ->required()
      ->check(wrong_sphere_mesh_name);
  command->add_option("--spheres", arguments->spheres, "how many spheres")
      ->required()
      ->check(CLI::Range(std::size_t{1}, std::size_t{1} << 31));
  command->add_flag("--json", arguments->json, "one JSON object: spheres, edges, triangles");
  command->footer(
      "A hierarchy holds every level from a sphere for each vertex of the input down to the last.\n\n"
      "Example:\n"
      "  armature spheremesh build cow.obj cow.ma --spheres 50 --hierarchy cow.smh\n"
      "  armature spheremesh level cow.smh cow_20.ma --spheres 20");
  command->callback([arguments, &run] { run = [arguments] { return run_level(*arguments); }; });
}

}  // namespace armature::tools
