#include "tools/training_ranks.h"

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <string>

#include <dlfcn.h>

#include "tracker/installation.h"

namespace armature::tools {
namespace {

/// A number that OpenMPI's mpirun puts into the environment of what it starts.
int from_mpirun(const char* name, int otherwise) {
  const char* const value = std::getenv(name);
  return value == nullptr ? otherwise : std::atoi(value);
}

Expected<std::unique_ptr<Ranks>> join_mpi_ranks() {
  const std::string path = installed_plugin("armature_mpi.so").string();
  // Global, for the plug-ins of MPI itself. Never closed: MPI may run once in a process.
  void* const library = dlopen(path.c_str(), RTLD_NOW | RTLD_GLOBAL);
  if (library == nullptr) {
    return fail("cannot join the others that mpirun started: " + std::string(dlerror()) +
                "; install openmpi-bin, or build again with libopenmpi-dev installed");
  }
  auto* const join = reinterpret_cast<Ranks* (*)()>(dlsym(library, "armature_join_mpi_ranks"));
  if (join == nullptr) return fail(path + ": not the plug-in of this version; build or install again");
  return std::unique_ptr<Ranks>(join());
}

}  // namespace

Expected<void> run_on_ranks(const std::function<Expected<void>(Ranks&)>& work) {
  if (from_mpirun("OMPI_COMM_WORLD_SIZE", 1) == 1) {
    OneRank alone;
    return work(alone);
  }
  const auto ranks = join_mpi_ranks();
  if (!ranks) {
    if (from_mpirun("OMPI_COMM_WORLD_RANK", 0) != 0) return {};
    return tl::unexpected(ranks.error());
  }
  try {
    const auto result = work(**ranks);
    return (*ranks)->rank() == 0 ? result : Expected<void>();
  } catch (const std::exception& unexpected) {
    std::fprintf(stderr, "armature: rank %d: %s\n", (*ranks)->rank(), unexpected.what());
    (*ranks)->abort();
    throw;
  }
}

}  // namespace armature::tools
