#include <charconv>
#include <cstdio>
#include <string_view>

#include "firmware_host/capture/capture_process.h"

// Started by CaptureProcess, and by nobody else: with its own process number and the source.
int main(int argc, char** argv) {
  const std::string_view number = argc == 3 ? argv[1] : "";
  pid_t parent = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), parent);
  if (error != std::errc() || end != number.data() + number.size()) {
    std::fputs("armature-capture: started by armatured, for one source; nothing to start by hand\n", stderr);
    return armature::kCaptureNotUnderstood;
  }
  return armature::run_capture(argv[2], parent, armature::kFramesDescriptor, armature::kWakeDescriptor);
}
