#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>

#include "tools/commands/appliance/appliance.h"
#include "tools/commands/commands.h"
#include "tools/commands/decimate/decimate.h"
#include "tools/commands/edit/edit.h"
#include "tools/commands/select/select.h"

namespace {

using namespace armature::tools;

void add_commands(CLI::App& app, Run& run) {
  add_bench(app, run);
  add_decimate(app, run);
  add_devices(app, run);
  add_doctor(app, run);
  add_edit(app, run);
  add_forest(app, run);
  add_import(app, run);
  add_keys(app, run);
  add_listen(app, run);
  add_mesh(app, run);
  add_record(app, run);
#ifdef ARMATURE_VIEWER
  add_render(app, run);
#endif
  add_replay(app, run);
  add_select(app, run);
  add_spheremesh(app, run);
  add_status(app, run);
  add_synth(app, run);
}

int run_command(int argc, char** argv) {
  CLI::App app{"Bodies and shapes, steered by hand.\nEvery subcommand explains itself: armature SUBCOMMAND --help",
               "armature"};
  app.require_subcommand(1);
  app.set_version_flag("--version", ARMATURE_VERSION);
  Run run;
  add_commands(app, run);

  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& done) {
    return app.exit(done);  // --help, --version
  } catch (const CLI::ParseError& wrong) {
    app.exit(wrong);
    return 2;
  }
  if (const auto result = run(); !result) {
    std::fprintf(stderr, "armature: %s\n", result.error().message.c_str());
    return 1;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run_command(argc, argv);
  } catch (const std::exception& unexpected) {
    std::fprintf(stderr, "armature: %s\n", unexpected.what());
    return 1;
  }
}
