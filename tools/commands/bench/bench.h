#pragma once

#include "tools/commands/commands.h"

namespace armature::tools {

// Each adds one subcommand to `armature bench`. One source file a benchmark.
void add_bench_collapse(CLI::App& bench, Run& run);
void add_bench_deform(CLI::App& bench, Run& run);
void add_bench_decimate(CLI::App& bench, Run& run);
void add_bench_descriptors(CLI::App& bench, Run& run);
void add_bench_select(CLI::App& bench, Run& run);
void add_bench_idle(CLI::App& bench, Run& run);
void add_bench_soak(CLI::App& bench, Run& run);
void add_bench_spheremesh(CLI::App& bench, Run& run);
void add_bench_steering(CLI::App& bench, Run& run);
void add_bench_tracker(CLI::App& bench, Run& run);

}  // namespace armature::tools
