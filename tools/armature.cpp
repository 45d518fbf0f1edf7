#include <cstdio>
#include <string>

#include <CLI/CLI.hpp>

#include "tools/commands/commands.h"

int main(int argc, char** argv) {
  CLI::App app{"armature: bodies and shapes, steered by hand", "armature"};
  app.require_subcommand(1);
  app.set_version_flag("--version", ARMATURE_VERSION);
  armature::tools::Run run;

  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& done) {
    return app.exit(done);  // --help, --version
  } catch (const CLI::ParseError& wrong) {
    app.exit(wrong);
    return 2;
  }
  const auto result = run();
  if (!result) {
    std::fprintf(stderr, "armature: %s\n", result.error().message.c_str());
    return 1;
  }
  return 0;
}
