#include <algorithm>
#include <cstdio>
#include <limits>
#include <memory>
#include <string>

#include <armature/sdk/hierarchy/build.h>
#include <armature/sdk/io/read_mesh.h>
#include <fmt/format.h>

#include "tools/commands/bench/bench.h"
#include "tools/json_lines.h"
#include "tools/peak_memory.h"
#include "tools/sdk_call.h"

namespace armature::tools {
namespace {

struct CollapseOptions {
  std::string mesh;
  int rounds = 3;
  bool json = false;
};

/// The complete hierarchy, a few times; the fastest run counts, since others use the machine too.
Expected<void> bench_collapse(const CollapseOptions& options) {
  SdkCall call;
  const auto mesh = ours(sdk::read_mesh(options.mesh, {}, call.task()));
  if (!mesh) return tl::unexpected(mesh.error());

  sdk::BuildStatistics fastest{.init_ms = std::numeric_limits<double>::infinity(),
                               .decimate_ms = std::numeric_limits<double>::infinity()};
  const double before_mb = (reset_peak_memory(), peak_memory_mb());
  double held_mb = 0;
  for (int round = 0; round < options.rounds; ++round) {
    const auto build = ours(sdk::build_hierarchy(*mesh, {}, call.task()));
    if (!build) return fail(options.mesh + ": " + build.error().message);
    if (round == 0) held_mb = peak_memory_mb() - before_mb;
    fastest.init_ms = std::min(fastest.init_ms, build->statistics.init_ms);
    fastest.decimate_ms = std::min(fastest.decimate_ms, build->statistics.decimate_ms);
    fastest.collapses = build->statistics.collapses;
  }
  if (fastest.collapses == 0) return fail(options.mesh + ": nothing to collapse");
  const double each_us = 1000 * fastest.decimate_ms / static_cast<double>(fastest.collapses);
  const double kb_a_vertex = 1024 * held_mb / static_cast<double>(mesh->positions.size());
  if (options.json) {
    return write_json_line(stdout, {{"peer", "armature"},
                                    {"collapses", fastest.collapses},
                                    {"ms", number(fastest.decimate_ms)},
                                    {"us_per_collapse", number(each_us)},
                                    {"init_ms", number(fastest.init_ms)},
                                    {"kb_per_vertex", number(kb_a_vertex)}});
  }
  std::printf("%s\n",
              fmt::format("{}: {} collapses in {:.1f} ms, {:.2f} us each, after {:.1f} ms of preparation; "
                          "{:.2f} KB a vertex at most",
                          options.mesh, fastest.collapses, fastest.decimate_ms, each_us, fastest.init_ms, kb_a_vertex)
                  .c_str());
  return {};
}

}  // namespace

void add_bench_collapse(CLI::App& bench, Run& run) {
  auto options = std::make_shared<CollapseOptions>();
  CLI::App* collapse = bench.add_subcommand(
      "collapse", "Time and memory of a complete hierarchy of sphere-meshes, on one core; the fastest of some rounds.");
  collapse->add_option("MESH", options->mesh, "a triangle mesh")->required();
  collapse->add_option("--rounds", options->rounds, "times it is built")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  collapse->add_flag("--json", options->json, "one JSON object");
  collapse->footer(
      "tools/bench holds it against meshoptimizer and CGAL, in one run.\n\n"
      "Example:\n  armature bench collapse cow.obj");
  collapse->callback([options, &run] { run = [options] { return bench_collapse(*options); }; });
}

}  // namespace armature::tools
