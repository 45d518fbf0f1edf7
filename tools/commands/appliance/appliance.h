#pragma once

#include "tools/commands/commands.h"

namespace armature::tools {

// The subcommands that look after an appliance. One source file each.
void add_devices(CLI::App& app, Run& run);
void add_doctor(CLI::App& app, Run& run);
void add_keys(CLI::App& app, Run& run);
void add_status(CLI::App& app, Run& run);

}  // namespace armature::tools
