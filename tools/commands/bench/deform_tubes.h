#pragma once

#include "tools/commands/bench/sections.h"

namespace armature::tools {

/// Bends straight tubes at hinges and says how much of their volume is lost or won, with the compactness that a build
/// finds by itself and without any.
[[nodiscard]] Expected<void> bench_tubes(const Report& report, SdkCall& call);

}  // namespace armature::tools
