#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include <armature/sdk/distance/measure.h>
#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/io/sphere_mesh_file.h>

#include "tools/commands/spheremesh/spheremesh.h"
#include "tools/json_lines.h"
#include "tools/sdk_call.h"

namespace armature::tools {
namespace {

struct Arguments {
  std::string mesh, approximation;
  std::size_t samples = sdk::MeasureOptions{}.samples;
  bool quick = false;
  bool as_mesh = false;
  bool json = false;
};

Expected<sdk::ApproximationErrors> compare(const Arguments& arguments, SdkCall& call) {
  const auto mesh = ours(sdk::read_mesh(arguments.mesh, {}, call.task()));
  if (!mesh) return tl::unexpected(mesh.error());
  const sdk::MeasureOptions options{.samples = arguments.samples, .quick = arguments.quick};
  const std::string where = arguments.mesh + ", " + arguments.approximation + ": ";
  const auto named = [&](auto result) {
    return std::move(result).map_error([&](sdk::Error&& error) { return Error{where + error.message}; });
  };
  if (!arguments.as_mesh && sdk::holds_sphere_mesh(arguments.approximation)) {
    const auto shape = ours(sdk::read_sphere_mesh(arguments.approximation, call.task()));
    if (!shape) return tl::unexpected(shape.error());
    return named(sdk::measure(*mesh, *shape, options, call.task()));
  }
  const auto other = ours(sdk::read_mesh(arguments.approximation, {}, call.task()));
  if (!other) return tl::unexpected(other.error());
  return named(sdk::measure(*mesh, *other, options, call.task()));
}

Expected<void> run_measure(const Arguments& arguments) {
  SdkCall call;
  const auto errors = compare(arguments, call);
  if (!errors) return tl::unexpected(errors.error());
  if (arguments.json)
    return write_json_line(stdout, {{"hausdorff", number(errors->hausdorff)},
                                    {"mean_input_to_approximation", number(errors->mean_input_to_approximation)},
                                    {"mean_approximation_to_input", number(errors->mean_approximation_to_input)}});
  std::printf("Hausdorff               %8.4f %%\n", errors->hausdorff);
  std::printf("input to approximation  %8.4f %%, mean\n", errors->mean_input_to_approximation);
  std::printf("approximation to input  %8.4f %%, mean\n", errors->mean_approximation_to_input);
  return {};
}

}  // namespace

void add_spheremesh_measure(CLI::App& spheremesh, Run& run) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = spheremesh.add_subcommand("measure", "Tell how far an approximation leaves its input.");
  command->add_option("MESH", arguments->mesh, "the input, a triangle mesh")->required();
  command->add_option("SPHEREMESH", arguments->approximation, "a sphere-mesh (.ma, .ply), or another triangle mesh")
      ->required();
  command->add_option("--samples", arguments->samples, "points on either surface")
      ->check(CLI::Range(std::size_t{100}, std::size_t{100'000'000}))
      ->capture_default_str();
  command->add_flag("--quick", arguments->quick,
                    "seconds for a hundred thousand spheres; the Hausdorff distance is then a lower bound");
  command->add_flag("--mesh", arguments->as_mesh, "take SPHEREMESH for a triangle mesh, even if it names radii");
  command->add_flag("--json", arguments->json,
                    "one JSON object: hausdorff, mean_input_to_approximation, mean_approximation_to_input");
  command->footer(
      "In percent of the diagonal of the input's bounding box. Of a sphere-mesh the outer surface counts: closed "
      "voids\n"
      "inside do not.\n\nExample:\n  armature spheremesh measure cow.obj cow.ma --json");
  command->callback([arguments, &run] { run = [arguments] { return run_measure(*arguments); }; });
}

}  // namespace armature::tools
