#pragma once

#include <functional>

#include "firmware_host/error.h"
#include "tracker/forest/ranks.h"

namespace armature::tools {

/// Calls work(ranks) with the ranks that mpirun started this process among, or with this process alone. Without the
/// plug-in for MPI a process among others is refused. One line of error for all ranks: failures that `work` returns
/// must be the same on all of them and are handed on by rank 0 alone; what it throws on one of several ends all.
[[nodiscard]] Expected<void> run_on_ranks(const std::function<Expected<void>(Ranks&)>& work);

}  // namespace armature::tools
