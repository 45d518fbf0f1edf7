#pragma once

#include "tools/commands/commands.h"

namespace armature::tools {

/// Adds `armature edit`; as those of commands.h.
void add_edit(CLI::App& app, Run& run);

}  // namespace armature::tools
