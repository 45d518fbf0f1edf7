#pragma once

#include "tools/commands/commands.h"

namespace armature::tools {

/// Adds `armature decimate`; as those of commands.h.
void add_decimate(CLI::App& app, Run& run);

}  // namespace armature::tools
