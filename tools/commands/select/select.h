#pragma once

#include "tools/commands/commands.h"

namespace armature::tools {

/// Adds `armature select`; as those of commands.h.
void add_select(CLI::App& app, Run& run);

}  // namespace armature::tools
