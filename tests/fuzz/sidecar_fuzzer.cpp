// Side-cars of recordings: what is accepted comes back from its own text.
#include <cstdint>
#include <string_view>

#include "firmware_host/recording/sidecar.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace armature;
  const auto facts = parse_sidecar({reinterpret_cast<const char*>(data), size}, "fuzzed.toml");
  if (!facts) {
    if (facts.error().message.find('\n') != std::string::npos) __builtin_trap();
    return 0;
  }
  const auto again = parse_sidecar(format_sidecar(*facts), "again.toml");
  if (!again || !(*again == *facts)) __builtin_trap();
  return 0;
}
