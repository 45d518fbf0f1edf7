// Moves of spheres: what is accepted can be carried out; what is not is refused in one line.
#include <cstdint>
#include <string_view>

#include "tools/commands/spheremesh/sphere_moves.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace armature;
  constexpr std::size_t kSpheres = 12;
  const auto moves = tools::parse_sphere_moves({reinterpret_cast<const char*>(data), size}, "fuzzed.json", kSpheres);
  if (!moves) {
    if (moves.error().message.find('\n') != std::string::npos) __builtin_trap();
    return 0;
  }
  for (const sdk::SphereMove& move : *moves)
    if (!sdk::check(move, kSpheres)) __builtin_trap();
  return 0;
}
