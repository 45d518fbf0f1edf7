#include <cstdlib>
#include <string>

#include "tracker/config.h"

// A configuration: whatever the bytes, it is refused in one line or it is one that prints and reads back to the same.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace armature;
  const auto config = parse_config({reinterpret_cast<const char*>(bytes), size}, "fuzzed.toml");
  if (!config) {
    if (config.error().message.find("fuzzed.toml") == std::string::npos) std::abort();
    return 0;
  }
  const std::string printed = print_config(*config);
  const auto again = parse_config(printed, "printed.toml");
  if (!again || print_config(*again) != printed) std::abort();
  return 0;
}
