#pragma once

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>

#include <armature/sdk/io/read_mesh.h>

namespace armature::peers {

/// The mesh that the command line names, or the end of the program.
inline sdk::Mesh mesh_of_command_line(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s MESH\nCollapses as far as it goes and prints the time as JSON.\n", argv[0]);
    std::exit(2);
  }
  auto mesh = sdk::read_mesh(argv[1]);
  if (!mesh) {
    std::fprintf(stderr, "%s\n", mesh.error().message.c_str());
    std::exit(1);
  }
  return std::move(*mesh);
}

/// Times `collapse`, which returns how many vertices it removed from `input`, and prints {"peer":..., "collapses":...,
/// "ms":..., "us_per_collapse":...}; or ends the program if there was nothing to collapse.
template <class Input, class Collapse>
void report(const char* peer, Input input, Collapse collapse) {
  const auto start = std::chrono::steady_clock::now();
  const std::size_t collapses = collapse(input);
  const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  if (collapses == 0) {
    std::fprintf(stderr, "%s: nothing to collapse\n", peer);
    std::exit(1);
  }
  std::printf("{\"peer\":\"%s\",\"collapses\":%zu,\"ms\":%.3f,\"us_per_collapse\":%.4f}\n", peer, collapses, ms,
              1000 * ms / static_cast<double>(collapses));
}

}  // namespace armature::peers
