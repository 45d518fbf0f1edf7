// A whole recording through OpenNI2's own player: what our checks let pass must neither crash nor stall it.
#include <cstdint>
#include <string>

#include <sys/mman.h>
#include <unistd.h>

#include "firmware_host/depth_source.h"

// The player keeps a little of every device that was closed.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libOniFile.so.0\nleak:libOpenNI2.so.0\n";
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace armature;
  static const int file = ::memfd_create("fuzzed.oni", MFD_CLOEXEC);
  if (::ftruncate(file, 0) != 0 || ::pwrite(file, data, size, 0) != static_cast<ssize_t>(size)) return 0;
  auto source = open_depth_source("oni:/proc/self/fd/" + std::to_string(file));
  if (!source) return 0;
  DepthFrame frame;
  for (long reads = 0; reads <= (*source)->info().frame_count; ++reads) {
    const auto status = (*source)->read(frame, std::chrono::seconds(1));
    if (!status || *status == ReadStatus::EndOfStream) return 0;
  }
  __builtin_trap();
}
