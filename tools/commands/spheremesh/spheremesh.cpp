#include "tools/commands/spheremesh/spheremesh.h"

namespace armature::tools {

void add_spheremesh(CLI::App& app, Run& run) {
  CLI::App* spheremesh =
      app.add_subcommand("spheremesh", "A shape as a few interpolated spheres: build it from a mesh, measure it.");
  spheremesh->require_subcommand(1);
  add_spheremesh_build(*spheremesh, run);
  add_spheremesh_deform(*spheremesh, run);
  add_spheremesh_extract(*spheremesh, run);
  add_spheremesh_level(*spheremesh, run);
  add_spheremesh_measure(*spheremesh, run);
  add_spheremesh_session(*spheremesh, run);
}

}  // namespace armature::tools
