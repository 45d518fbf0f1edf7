#pragma once

#include "tools/commands/commands.h"

namespace armature::tools {

// Each adds one subcommand to `armature spheremesh`. One source file a subcommand.
void add_spheremesh_build(CLI::App& spheremesh, Run& run);
void add_spheremesh_deform(CLI::App& spheremesh, Run& run);
void add_spheremesh_extract(CLI::App& spheremesh, Run& run);
void add_spheremesh_level(CLI::App& spheremesh, Run& run);
void add_spheremesh_measure(CLI::App& spheremesh, Run& run);
void add_spheremesh_session(CLI::App& spheremesh, Run& run);

}  // namespace armature::tools
