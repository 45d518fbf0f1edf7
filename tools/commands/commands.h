#pragma once

#include <functional>

#include <CLI/CLI.hpp>

#include "firmware_host/error.h"

namespace armature::tools {

/// What the chosen subcommand does once the command line has been parsed. A failure is printed as one line on stderr
/// and the program exits 1; wrong use exits 2 before this is called.
using Run = std::function<Expected<void>()>;

// Each adds one subcommand to `app` and sets `run` when the user names it. One source file a command, in the order of
// the alphabet. Listed here, in add_commands() of tools/armature.cpp and in tools/CMakeLists.txt.
void add_bench(CLI::App& app, Run& run);
void add_forest(CLI::App& app, Run& run);
void add_import(CLI::App& app, Run& run);
void add_listen(CLI::App& app, Run& run);
void add_mesh(CLI::App& app, Run& run);
void add_record(CLI::App& app, Run& run);
void add_render(CLI::App& app, Run& run);  // where the viewer is built
void add_replay(CLI::App& app, Run& run);
void add_spheremesh(CLI::App& app, Run& run);
void add_synth(CLI::App& app, Run& run);

struct TrackerSetup;
/// The options of every command that runs the tracker: --config, --model, --rest.
void add_tracker_setup(CLI::App& command, TrackerSetup& setup);

}  // namespace armature::tools
