#include "tools/commands/bench/bench.h"

namespace armature::tools {

void add_bench(CLI::App& app, Run& run) {
  CLI::App* bench = app.add_subcommand("bench", "Measure speed and accuracy on this machine.");
  bench->require_subcommand(1);
  add_bench_collapse(*bench, run);
  add_bench_deform(*bench, run);
  add_bench_decimate(*bench, run);
  add_bench_descriptors(*bench, run);
  add_bench_select(*bench, run);
  add_bench_idle(*bench, run);
  add_bench_soak(*bench, run);
  add_bench_spheremesh(*bench, run);
  add_bench_steering(*bench, run);
  add_bench_tracker(*bench, run);
}

}  // namespace armature::tools
