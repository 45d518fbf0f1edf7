// INDEX.txt of a fakenect dump: no name leaves the folder, no time runs backwards.
#include <cstdint>
#include <string_view>

#include "firmware_host/backends/freenect.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace armature;
  const auto entries = parse_fakenect_index({reinterpret_cast<const char*>(data), size}, "INDEX.txt");
  if (!entries) {
    if (entries.error().message.find('\n') != std::string::npos) __builtin_trap();
    return 0;
  }
  auto before = entries->front().time;
  for (const FakenectEntry& entry : *entries) {
    if (entry.file.find('/') != std::string::npos || entry.time < before) __builtin_trap();
    before = entry.time;
  }
  return 0;
}
