#include "tools/peak_memory.h"

#include <cstdio>
#include <memory>

namespace armature::tools {
namespace {

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

}  // namespace

void reset_peak_memory() noexcept {
  // proc(5): 5 resets the peak of the resident set.
  if (const File file(std::fopen("/proc/self/clear_refs", "w"), &std::fclose); file) std::fputs("5", file.get());
}

double peak_memory_mb() noexcept {
  const File file(std::fopen("/proc/self/status", "r"), &std::fclose);
  if (!file) return 0;
  char line[256];
  while (std::fgets(line, sizeof line, file.get()) != nullptr) {
    unsigned long kilobytes = 0;
    if (std::sscanf(line, "VmHWM: %lu kB", &kilobytes) == 1) return static_cast<double>(kilobytes) / 1024;
  }
  return 0;
}

}  // namespace armature::tools
