#pragma once

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>
#include <utility>

#include <armature/sdk/io/read_mesh.h>

namespace armature::peers {

/// The mesh that the command line names, or the end of the program.
inline sdk::Mesh mesh_of_command_line(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s MESH\nCollapses as far as it goes, three times; prints the fastest as JSON.\n",
                 argv[0]);
    std::exit(2);
  }
  auto mesh = sdk::read_mesh(argv[1]);
  if (!mesh) {
    std::fprintf(stderr, "%s\n", mesh.error().message.c_str());
    std::exit(1);
  }
  return std::move(*mesh);
}

/// Runs `collapse`, which returns how many vertices it removed, a few times on inputs that `prepare` makes, and prints
/// the fastest run: {"peer":..., "collapses":..., "ms":..., "us_per_collapse":...}.
template <class Prepare, class Collapse>
void report(const char* peer, Prepare prepare, Collapse collapse) {
  double best_ms = std::numeric_limits<double>::infinity();
  std::size_t collapses = 0;
  for (int round = 0; round < 3; ++round) {
    auto input = prepare();
    const auto start = std::chrono::steady_clock::now();
    collapses = collapse(input);
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
    best_ms = std::min(best_ms, elapsed.count());
  }
  std::printf("{\"peer\":\"%s\",\"collapses\":%zu,\"ms\":%.3f,\"us_per_collapse\":%.4f}\n", peer, collapses, best_ms,
              1000 * best_ms / static_cast<double>(collapses));
}

}  // namespace armature::peers
